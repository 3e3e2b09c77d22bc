#include "core/base/trace.h"
#include "core/codec/chunk_rows.h"
#include "kernels/pack/column_bytes.cuh"
#include "kernels/pack/pack_chunks.cuh"

namespace gigabake::kernels {
namespace {

/// Copies bytes from the device to a page-locked host buffer, waits for the copy and sets `arrived` to the copied
/// bytes.
std::shared_ptr<PinnedBuffer> read_back(DeviceHeap& heap, const std::uint8_t* bytes, std::size_t size,
                                        PinnedPool& pinned, const std::uint8_t*& arrived) {
  std::shared_ptr<PinnedBuffer> buffer = pinned.take(size);
  const TraceSpan span("read back bytes");
  std::byte* to = buffer->reserve(size);
  download_async(to, bytes, size, heap.stream(), "cudaMemcpyAsync (columns)");
  wait_for(heap.stream(), "cudaStreamSynchronize (columns)");
  arrived = reinterpret_cast<const std::uint8_t*>(to);
  return buffer;
}

}  // namespace

std::shared_ptr<const void> read_back_raw(DeviceHeap& heap, const DeviceArray<std::uint8_t>& raw,
                                          const std::vector<RawColumn>& columns, PinnedPool& pinned) {
  const std::uint8_t* arrived = nullptr;
  std::shared_ptr<PinnedBuffer> buffer = read_back(heap, raw.data(), raw.size(), pinned, arrived);
  for (const RawColumn& c : columns) c.column->raw = {arrived + c.at, c.column->rows * c.shape.bytes};
  return buffer;
}

std::shared_ptr<const void> read_back_stored(DeviceHeap& heap, const DeviceArray<std::uint8_t>& raw,
                                             const std::vector<RawColumn>& columns, PinnedPool& pinned) {
  std::vector<RawChunk> chunks;
  for (const RawColumn& c : columns) {
    const std::size_t bytes = chunk_bytes(c.column->rows, c.shape.bytes);
    for (std::size_t at = 0; at < c.bytes; at += bytes)
      chunks.push_back(
          {c.at + at, std::uint32_t(bytes), std::uint32_t(c.shape.shuffled_bytes), c.shape.min_match_bytes});
  }
  const TraceSpan span("compress and read back");
  const PackedChunks packed = pack_chunks(heap, raw.data(), chunks, nullptr);
  const std::uint8_t* arrived = nullptr;
  std::shared_ptr<PinnedBuffer> buffer = read_back(heap, packed.bytes.data(), packed.ends.back(), pinned, arrived);
  std::size_t chunk = 0;
  std::uint64_t begin = 0;
  for (const RawColumn& c : columns)
    for (std::size_t n = chunk_count(c.column->rows, c.shape.bytes); n > 0; --n, ++chunk) {
      c.column->stored.push_back({arrived + begin, packed.ends[chunk] - begin});
      begin = packed.ends[chunk];
    }
  return buffer;
}

}  // namespace gigabake::kernels
