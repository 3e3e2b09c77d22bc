// Computes each block's codes and header from symbol counts, and the positions of blocks and chunks.
#include <cub/block/block_scan.cuh>

#include "kernels/pack/batch.cuh"

namespace gigabake::kernels::pack {
namespace {

constexpr unsigned placers = 256;

/// Writes the keys of all symbols with a count above 0 to `keys`, in ascending order. Returns the number of keys. The
/// index of a key is the number of smaller keys. All lanes of a warp must call this function.
__device__ std::uint32_t order(const std::uint32_t* counts, std::uint32_t symbols, std::uint32_t* keys) {
  std::uint32_t used = 0;
  for (std::uint32_t s = threadIdx.x; s < symbols; s += 32) {
    const std::uint32_t key = deflate::order_key(counts[s], s);
    if (key == 0) continue;
    std::uint32_t place = 0;
    for (std::uint32_t other = 0; other < symbols; ++other) {
      const std::uint32_t theirs = deflate::order_key(counts[other], other);
      place += theirs != 0 && theirs < key ? 1 : 0;
    }
    keys[place] = key;
    ++used;
  }
  return __reduce_add_sync(~0u, used);
}

/// Computes the number of bits before each segment. All lanes of a warp must call this function. Returns the number of
/// bits of all segments.
__device__ std::uint32_t place_segments(const std::uint32_t* tokens, const deflate::Code* codes, BlockPlace& block) {
  std::uint32_t before = 0;
  for (std::uint32_t s = 0; s < deflate::segments_per_block; ++s) {
    const std::uint32_t* mine = tokens + s * deflate::segment_bytes;
    std::uint32_t bits = 0;
    for (std::uint32_t t = threadIdx.x; t < block.segment_tokens[s]; t += 32)
      bits += deflate::bits_of(mine[t], codes).count;
    if (threadIdx.x == 0) block.segment_bits[s] = before;
    before += __reduce_add_sync(~0u, bits);
  }
  return before;
}

/// Computes the codes, header and size of each block, with one warp per block. A single lane builds the Huffman tree,
/// so the other lanes wait a few hundred steps.
__global__ void __launch_bounds__(32) codes(Batch batch) {
  __shared__ std::uint32_t counts[deflate::block_symbols];
  __shared__ deflate::BlockWork work;
  __shared__ deflate::BlockCodes made;
  const std::uint32_t lane = threadIdx.x;
  BlockPlace& block = batch.blocks[blockIdx.x];
  BlockSymbols& symbols = batch.symbols[blockIdx.x];
  const ChunkPlace& chunk = batch.chunks[block.chunk];
  for (std::uint32_t s = lane; s < deflate::block_symbols; s += 32) counts[s] = symbols.counts[s];
  __syncwarp();
  std::uint32_t* const of_distances = counts + deflate::literal_symbols;
  if (lane == 0) deflate::ensure_two(counts, deflate::literal_symbols);
  if (lane == 1) deflate::ensure_two(of_distances, deflate::distance_symbols);
  __syncwarp();
  const std::uint32_t literals = order(counts, deflate::literal_symbols, work.keys);
  const std::uint32_t distances = order(of_distances, deflate::distance_symbols, work.keys + deflate::literal_symbols);
  __syncwarp();
  if (lane == 0) {
    work.used_literals = literals;
    work.used_distances = distances;
    deflate::make_block_codes(work, blockIdx.x + 1 == chunk.first_block + chunk.blocks, made);
  }
  __syncwarp();
  for (std::uint32_t s = lane; s < deflate::block_symbols; s += 32) symbols.codes.codes[s] = made.codes[s];
  for (std::uint32_t w = lane; 32 * w < made.header_bits; w += 32) symbols.codes.header[w] = made.header[w];
  const std::uint32_t of_segments = place_segments(batch.words + chunk.staged + block.begin, made.codes, block);
  if (lane != 0) return;
  symbols.codes.header_bits = made.header_bits;
  block.bits = made.header_bits + of_segments + deflate::bits_of(deflate::end_of_block, made.codes).count;
}

/// Sets first_bit of each block of the chunk, and as_is and packed_bytes of the chunk. Returns packed_bytes.
__device__ std::uint32_t place_blocks(const Batch& batch, ChunkPlace& chunk) {
  std::uint64_t bits = 0;
  for (std::uint32_t b = chunk.first_block; b < chunk.first_block + chunk.blocks; ++b) {
    batch.blocks[b].first_bit = bits;
    bits += batch.blocks[b].bits;
  }
  chunk.as_is = deflate::stored_as_is(chunk.bytes, bits) ? 1 : 0;
  return chunk.packed_bytes = deflate::frame_bytes + deflate::deflate_size(chunk.bytes, bits);
}

/// Computes the offset of each packed chunk. One thread block processes all chunks, because there are few chunks.
__global__ void __launch_bounds__(placers) place(Batch batch) {
  using Scan = cub::BlockScan<std::uint64_t, placers>;
  __shared__ typename Scan::TempStorage temp_storage;
  std::uint64_t end = *batch.packed_end;
  __syncthreads();
  for (std::uint32_t first = 0; first < batch.chunk_count; first += placers) {
    const std::uint32_t c = first + threadIdx.x;
    const std::uint64_t mine = c < batch.chunk_count ? place_blocks(batch, batch.chunks[c]) : 0;
    std::uint64_t before, all;
    Scan(temp_storage).ExclusiveSum(mine, before, all);
    if (c < batch.chunk_count) {
      batch.chunks[c].packed = end + before;
      batch.ends[c] = end + before + mine;
    }
    end += all;
    __syncthreads();
  }
  if (threadIdx.x == 0) *batch.packed_end = end;
}

}  // namespace

void make_codes(const Batch& batch, cudaStream_t stream) {
  codes<<<batch.block_count, 32, 0, stream>>>(batch);
  check_launch("codes");
}

void place_chunks(const Batch& batch, cudaStream_t stream) {
  place<<<1, placers, 0, stream>>>(batch);
  check_launch("place");
}

}  // namespace gigabake::kernels::pack
