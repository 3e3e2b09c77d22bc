/// A batch of chunks while it is packed: its arrays on the device, and the steps over them.
///
/// A warp or a few have a block of deflate, each lane or warp a segment of it. What a chunk repeats reaches back across
/// blocks, so that candidates are found for each block from 32 KiB before it on, and nothing waits for its neighbour.
#pragma once

#include <cstdint>

#include "kernels/cuda/memory.cuh"
#include "lattice/pack/block_codes.h"
#include "lattice/pack/matches.h"
#include "lattice/pack/stored_chunk.h"

namespace gigabake::kernels::pack {

/// A chunk of the batch. Filled by the host, but for the last two.
struct ChunkPlace {
  std::uint64_t raw;  ///< its first byte among the raw ones
  std::uint32_t bytes, element_bytes;
  std::uint32_t staged;               ///< its first byte in Batch::bytes, a multiple of 16, and in Batch::words
  std::uint32_t first_block, blocks;  ///< among the batch's
  std::uint32_t as_is;                ///< 1: in stored blocks
  std::uint32_t packed_bytes;         ///< as stored, both checksums included
  std::uint64_t packed;               ///< its first byte in the result
};

/// A block of deflate. Bits begin at the chunk's first block, words and bytes at the chunk's.
struct BlockPlace {
  std::uint32_t chunk;
  std::uint32_t begin, end;  ///< its bytes in the chunk
  std::uint64_t first_bit, bits;
  std::uint32_t segment_tokens[deflate::segments_per_block];
  std::uint32_t segment_bits[deflate::segments_per_block];  ///< before each segment, from the block's first bit on
};

/// Symbols of a block and how often each occurs, then what it is written with.
struct BlockSymbols {
  std::uint32_t counts[deflate::block_symbols];
  deflate::BlockCodes codes;
};

struct Batch {
  const std::uint8_t* raw;
  ChunkPlace* chunks;
  BlockPlace* blocks;
  BlockSymbols* symbols;  ///< a block's
  std::uint8_t* bytes;    ///< all chunks, shuffled where they are to be
  std::uint32_t* words;   ///< for each byte: its bucket before it, then its match, then tokens of its segment
  std::uint32_t chunk_count, block_count;
  std::uint8_t* packed;       ///< the result, zero where nothing is yet
  std::uint64_t* packed_end;  ///< where the batch before ended, then where this one does
  std::uint64_t* ends;        ///< of each chunk of the batch, in the result
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
