#include <algorithm>

#include "kernels/pack/batch.cuh"
#include "kernels/pack/pack_chunks.cuh"

namespace gigabake::kernels {
namespace {

/// The layout of a batch, computed on the host before the batch runs.
struct BatchPlan {
  std::vector<pack::ChunkPlace> chunks;
  std::vector<pack::BlockPlace> blocks;
  std::uint64_t staged_bytes = 0;
};

void add_chunk(const RawChunk& chunk, BatchPlan& plan) {
  const std::uint32_t blocks = deflate::blocks_of(chunk.bytes);
  pack::ChunkPlace place{};
  place.raw = chunk.begin;
  place.bytes = chunk.bytes;
  place.element_bytes = chunk.element_bytes;
  place.min_match_bytes = chunk.min_match_bytes;
  place.staged = std::uint32_t(plan.staged_bytes);
  place.first_block = std::uint32_t(plan.blocks.size());
  place.blocks = blocks;
  for (std::uint32_t b = 0; b < blocks; ++b) {
    pack::BlockPlace block{};
    block.chunk = std::uint32_t(plan.chunks.size());
    block.begin = b * deflate::block_bytes;
    block.end = std::min(chunk.bytes, block.begin + deflate::block_bytes);
    plan.blocks.push_back(block);
  }
  plan.chunks.push_back(place);
  // Chunks begin at multiples of 16 bytes. Reads beyond a chunk's end do not reach the next chunk.
  plan.staged_bytes += (std::uint64_t(chunk.bytes) + deflate::readable_beyond + 15) / 16 * 16;
}

/// Plans the batch that begins with chunk `first`, of at most `max_bytes` or one chunk.
BatchPlan plan_batch(std::span<const RawChunk> chunks, std::size_t first, std::uint64_t max_bytes) {
  BatchPlan plan;
  for (; first < chunks.size(); ++first) {
    if (chunks[first].bytes > max_packed_chunk_bytes)
      throw CudaFailure("a chunk of " + std::to_string(chunks[first].bytes) + " bytes is packed on the host only");
    if (!plan.chunks.empty() && plan.staged_bytes + chunks[first].bytes > max_bytes) break;
    add_chunk(chunks[first], plan);
  }
  return plan;
}

void pack_batch(DeviceHeap& heap, const BatchPlan& plan, pack::Batch batch, StreamClock* clock) {
  const DeviceArray<pack::ChunkPlace> chunks = uploaded(heap, plan.chunks.data(), plan.chunks.size());
  const DeviceArray<pack::BlockPlace> blocks = uploaded(heap, plan.blocks.data(), plan.blocks.size());
  const DeviceArray<pack::BlockSymbols> symbols(heap, plan.blocks.size());
  const DeviceArray<std::uint8_t> bytes(heap, plan.staged_bytes);
  const DeviceArray<std::uint32_t> words(heap, plan.staged_bytes);
  batch.chunks = chunks.data();
  batch.blocks = blocks.data();
  batch.symbols = symbols.data();
  batch.bytes = bytes.data();
  batch.words = words.data();
  batch.chunk_count = std::uint32_t(plan.chunks.size());
  batch.block_count = std::uint32_t(plan.blocks.size());
  const auto mark = [&](int step) {
    if (clock != nullptr) clock->mark(step);
  };
  mark(0);
  pack::stage_bytes(batch, heap.stream());
  pack::find_candidates(batch, heap.stream());
  mark(1);
  pack::find_matches(batch, heap.stream());
  mark(2);
  pack::parse_blocks(batch, heap.stream());
  mark(3);
  pack::make_codes(batch, heap.stream());
  pack::place_chunks(batch, heap.stream());
  mark(4);
  pack::write_blocks(batch, heap.stream());
  mark(5);
  pack::add_checksums(batch, heap.stream());
  mark(6);
}

/// Returns the max total size of the packed chunks.
std::uint64_t max_bytes(std::span<const RawChunk> chunks) {
  std::uint64_t bytes = 0;
  for (const RawChunk& c : chunks) bytes += deflate::frame_bytes + deflate::stored_size(c.bytes);
  return bytes;
}

}  // namespace

PackedChunks pack_chunks(DeviceHeap& heap, const std::uint8_t* raw, std::span<const RawChunk> chunks,
                         StreamClock* clock) {
  PackedChunks packed;
  packed.ends.resize(chunks.size());
  if (chunks.empty()) return packed;
  // Bits are set in whole words; the last word may extend beyond the last byte.
  packed.bytes = DeviceArray<std::uint8_t>(heap, (max_bytes(chunks) + 7) / 4 * 4);
  packed.bytes.clear_to_zero();
  DeviceArray<std::uint64_t> ends(heap, chunks.size()), packed_end(heap, 1);
  packed_end.clear_to_zero();
  const std::uint64_t batch_bytes =
      std::clamp(heap.available() / memory_per_batch_byte, min_pack_batch_bytes, pack_batch_bytes);
  for (std::size_t first = 0; first < chunks.size();) {
    const BatchPlan plan = plan_batch(chunks, first, batch_bytes);
    pack::Batch batch{};
    batch.raw = raw;
    batch.packed = packed.bytes.data();
    batch.packed_end = packed_end.data();
    batch.ends = ends.data() + first;
    pack_batch(heap, plan, batch, clock);
    first += plan.chunks.size();
  }
  heap.bring(packed.ends.data(), ends.data(), ends.bytes(), "packing chunks");
  return packed;
}

}  // namespace gigabake::kernels
