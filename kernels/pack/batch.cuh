/// A batch of chunks during packing: its arrays on the device, and the kernels that process them.
///
/// One or more warps process a deflate block; each lane or warp processes a segment of the block. Matches may cross
/// block borders: each block hashes the preceding 32 KiB itself, so blocks are independent.
#pragma once

#include <cstdint>

#include "core/codec/block_codes.h"
#include "core/codec/matches.h"
#include "core/codec/stored_chunk.h"
#include "kernels/cuda/device/memory.cuh"

namespace gigabake::kernels::pack {

/// A chunk of the batch. The host sets all members but the last three, which place_chunks() sets.
struct ChunkPlace {
  std::uint64_t raw;  ///< offset of the chunk's first byte in Batch::raw
  std::uint32_t bytes, element_bytes, min_match_bytes;
  std::uint32_t staged;               ///< offset in Batch::bytes and Batch::words, a multiple of 16
  std::uint32_t first_block, blocks;  ///< index of the first block in Batch::blocks, and number of blocks
  std::uint32_t as_is;                ///< 1: the chunk has stored (uncompressed) blocks
  std::uint32_t packed_bytes;         ///< size in storage format, including both checksums
  std::uint64_t packed;               ///< offset of the chunk in Batch::packed
};

/// A deflate block. first_bit is relative to the first block of the chunk; begin and end are relative to the chunk.
struct BlockPlace {
  std::uint32_t chunk;
  std::uint32_t begin, end;  ///< range of bytes in the chunk
  std::uint64_t first_bit, bits;
  std::uint32_t segment_tokens[deflate::segments_per_block];
  std::uint32_t segment_bits[deflate::segments_per_block];  ///< number of bits before each segment, without the header
};

/// The symbol counts of a block, then its codes and header.
struct BlockSymbols {
  std::uint32_t counts[deflate::block_symbols];
  deflate::BlockCodes codes;
};

struct Batch {
  const std::uint8_t* raw;
  ChunkPlace* chunks;
  BlockPlace* blocks;
  BlockSymbols* symbols;  ///< one per block
  std::uint8_t* bytes;    ///< all chunks, shuffled if requested
  std::uint32_t* words;   ///< per byte: the candidate's bucket, later the match, finally tokens of the segment
  std::uint32_t chunk_count, block_count;
  std::uint8_t* packed;       ///< the result; unwritten bytes are zero
  std::uint64_t* packed_end;  ///< end of the previous batch in `packed`; place_chunks() sets the end of this batch
  std::uint64_t* ends;        ///< the end of each chunk of the batch in `packed`
};

void stage_bytes(const Batch& batch, cudaStream_t stream);
void find_candidates(const Batch& batch, cudaStream_t stream);
void find_matches(const Batch& batch, cudaStream_t stream);
void parse_blocks(const Batch& batch, cudaStream_t stream);
void make_codes(const Batch& batch, cudaStream_t stream);
void place_chunks(const Batch& batch, cudaStream_t stream);
void write_blocks(const Batch& batch, cudaStream_t stream);
void add_checksums(const Batch& batch, cudaStream_t stream);

}  // namespace gigabake::kernels::pack
