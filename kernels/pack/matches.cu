// Computes the match of each position from the raw bytes, and the tokens of each segment.
#include "core/codec/shuffle.h"
#include "kernels/pack/batch.cuh"

namespace gigabake::kernels::pack {
namespace {

constexpr unsigned threads = 256,
                   parts = 8;  ///< thread blocks per deflate block in kernels that process each byte separately

/// The bytes of a deflate block that one thread processes: begin, begin + threads and so on, below `end`.
struct Part {
  std::uint32_t begin, end;
};
__device__ Part part_of(const BlockPlace& block) {
  const std::uint32_t share = deflate::block_bytes / parts, begin = block.begin + blockIdx.x % parts * share;
  return {begin + threadIdx.x, min(begin + share, block.end)};
}

__global__ void __launch_bounds__(threads) stage(Batch batch) {
  const BlockPlace& block = batch.blocks[blockIdx.x / parts];
  const ChunkPlace chunk = batch.chunks[block.chunk];
  const Part part = part_of(block);
  for (std::uint32_t i = part.begin; i < part.end; i += threads)
    batch.bytes[chunk.staged + i] = batch.raw[chunk.raw + shuffled_from(i, chunk.bytes, chunk.element_bytes)];
}

/// The hash table that a warp updates. `words` receives the table's previous entry for each position. If it is null,
/// the previous entries are discarded.
struct Entering {
  deflate::Bucket* table;
  std::uint32_t* words;
};

/// Enters one position per lane into the hash table. Skips positions from `end` on. The candidate of a position is the
/// highest lower position of the warp that has the same bucket. If there is none, the candidate is the table's entry
/// before the update.
__device__ void enter_32(std::uint32_t warp_position, std::uint32_t four, std::uint32_t end, const Entering& to) {
  const std::uint32_t lane = threadIdx.x, position = warp_position + lane;
  const bool entered = position < end;
  const std::uint32_t bucket = entered ? deflate::bucket_of(four) : deflate::buckets + lane;
  const unsigned alike = __match_any_sync(~0u, bucket), mine = 1u << lane, lower = alike & (mine - 1);
  deflate::Bucket found = entered ? to.table[bucket] : deflate::Bucket(0);
  if (lower != 0) found = deflate::bucket_with(warp_position + deflate::floor_log2(lower));
  __syncwarp();
  if (entered && alike < 2 * std::uint64_t(mine)) to.table[bucket] = deflate::bucket_with(position);
  if (entered && to.words != nullptr) to.words[position] = found;
  __syncwarp();
}

/// Enters positions [begin, end) into the hash table, 32 at a time. One warp must call this function. Bytes are read
/// 256 positions ahead to hide the memory latency.
__device__ void enter(const std::uint8_t* bytes, std::uint32_t begin, std::uint32_t end, const Entering& to) {
  constexpr std::uint32_t steps = 8;
  std::uint32_t four[steps], next[steps];
  const auto read = [&](std::uint32_t at) {
    GB_UNROLL
    for (std::uint32_t s = 0; s < steps; ++s) {
      const std::uint32_t position = at + 32 * s + threadIdx.x;
      next[s] = position < end ? deflate::four_bytes(bytes + position) : 0;
    }
  };
  read(begin);
  for (std::uint32_t at = begin; at < end; at += 32 * steps) {
    GB_UNROLL
    for (std::uint32_t s = 0; s < steps; ++s) four[s] = next[s];
    read(at + 32 * steps);
    GB_UNROLL
    for (std::uint32_t s = 0; s < steps; ++s) enter_32(at + 32 * s, four[s], end, to);
  }
}

/// Finds the match candidate of each position, with one warp per deflate block.
__global__ void __launch_bounds__(32) candidates(Batch batch) {
  __shared__ deflate::Bucket table[deflate::buckets];
  const BlockPlace& block = batch.blocks[blockIdx.x];
  const ChunkPlace chunk = batch.chunks[block.chunk];
  const std::uint8_t* bytes = batch.bytes + chunk.staged;
  std::uint32_t* words = batch.words + chunk.staged;
  const std::uint32_t lane = threadIdx.x, begin = block.begin, end = deflate::entered_before(chunk.bytes, block.end);
  const std::uint32_t earlier = begin < deflate::block_bytes ? begin : begin - deflate::block_bytes;
  for (std::uint32_t b = lane; b < deflate::buckets; b += 32) table[b] = deflate::empty_bucket(earlier);
  __syncwarp();
  if (earlier < begin) {
    enter(bytes, earlier, min(begin, end), {table, nullptr});
    for (std::uint32_t b = lane; b < deflate::buckets; b += 32) table[b] = deflate::aged(table[b], begin);
    __syncwarp();
  }
  enter(bytes, begin, end, {table, words});
  for (std::uint32_t p = max(begin, end) + lane; p < block.end; p += 32) words[p] = deflate::empty_bucket(p);
}

__global__ void __launch_bounds__(threads) matches(Batch batch) {
  const BlockPlace& block = batch.blocks[blockIdx.x / parts];
  const std::uint32_t staged = batch.chunks[block.chunk].staged, min_bytes = batch.chunks[block.chunk].min_match_bytes;
  const Part part = part_of(block);
  for (std::uint32_t p = part.begin; p < part.end; p += threads) {
    std::uint32_t& word = batch.words[staged + p];
    const std::uint32_t end = deflate::segment_end(p, block.end);
    const deflate::Match match = deflate::match_in(deflate::Bucket(word), batch.bytes + staged, p, end, min_bytes - 1);
    word = deflate::match_token(match.length, match.distance);
  }
}

/// Parses the segments into tokens, with one warp per deflate block and one lane per segment.
__global__ void __launch_bounds__(32) parse(Batch batch) {
  __shared__ std::uint32_t counts[deflate::block_symbols];
  BlockPlace& block = batch.blocks[blockIdx.x];
  const std::uint32_t staged = batch.chunks[block.chunk].staged, lane = threadIdx.x;
  for (std::uint32_t s = lane; s < deflate::block_symbols; s += 32) counts[s] = s == deflate::end_of_block ? 1 : 0;
  __syncwarp();
  const std::uint32_t begin = block.begin + lane * deflate::segment_bytes;
  std::uint32_t tokens = 0;
  if (begin < block.end) {
    // A segment has at most as many tokens as bytes, so tokens overwrite only matches that were read already.
    std::uint32_t *const words = batch.words + staged, *const to = words + begin;
    const auto match_at = [&](std::uint32_t p, std::uint32_t, std::uint32_t) { return deflate::match_of(words[p]); };
    const auto add = [&](deflate::Token token) {
      to[tokens++] = token;
      deflate::count_symbols(token, [&](std::uint32_t symbol) { atomicAdd(&counts[symbol], 1u); });
    };
    deflate::parse_segment(batch.bytes + staged, begin, deflate::segment_end(begin, block.end),
                           batch.chunks[block.chunk].min_match_bytes, match_at, add);
  }
  block.segment_tokens[lane] = tokens;
  __syncwarp();
  for (std::uint32_t s = lane; s < deflate::block_symbols; s += 32) batch.symbols[blockIdx.x].counts[s] = counts[s];
}

}  // namespace

void stage_bytes(const Batch& batch, cudaStream_t stream) {
  stage<<<batch.block_count * parts, threads, 0, stream>>>(batch);
  check_launch("stage");
}

void find_candidates(const Batch& batch, cudaStream_t stream) {
  candidates<<<batch.block_count, 32, 0, stream>>>(batch);
  check_launch("candidates");
}

void find_matches(const Batch& batch, cudaStream_t stream) {
  matches<<<batch.block_count * parts, threads, 0, stream>>>(batch);
  check_launch("matches");
}

void parse_blocks(const Batch& batch, cudaStream_t stream) {
  parse<<<batch.block_count, 32, 0, stream>>>(batch);
  check_launch("parse");
}

}  // namespace gigabake::kernels::pack
