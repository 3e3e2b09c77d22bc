#include "kernels/cuda/device/stream.cuh"
#include "kernels/pack/device_pack.h"
#include "kernels/pack/pack_chunks.cuh"

namespace gigabake::kernels {
namespace {

/// Returns the seconds of each step of the last batch.
std::array<double, 6> steps(const StreamClock& clock) {
  std::array<double, 6> seconds{};
  for (int i = 0; i < 6; ++i) seconds[std::size_t(i)] = clock.between(i, i + 1);
  return seconds;
}

}  // namespace

DevicePacked pack_on_device(int device, std::span<const std::uint8_t> raw, std::span<const RawChunk> chunks,
                            int rounds) {
  const Stream stream(device);
  DeviceMemoryStats memory_stats;
  DevicePacked result;
  {
    DeviceHeap heap(stream.handle, memory_stats);
    DeviceArray<std::uint8_t> bytes(heap, raw.size() + 1);
    check_cuda(cudaMemcpyAsync(bytes.data(), raw.data(), raw.size(), cudaMemcpyHostToDevice, stream.handle),
               "cudaMemcpyAsync");
    StreamClock whole(stream.handle), clock(stream.handle);
    for (int round = 0; round < rounds; ++round) {
      whole.mark(0);
      const PackedChunks packed = pack_chunks(heap, bytes.data(), chunks, &clock);
      whole.mark(1);
      const std::uint64_t size = packed.ends.empty() ? 0 : packed.ends.back();
      result.bytes.resize(size);
      result.ends = packed.ends;
      if (size > 0) heap.bring(result.bytes.data(), packed.bytes.data(), size, "packed chunks");
      check_cuda(cudaStreamSynchronize(stream.handle), "cudaStreamSynchronize");
      result.seconds.push_back(whole.between(0, 1));
      if (!chunks.empty()) result.step_seconds = steps(clock);
    }
  }
  result.peak_bytes = memory_stats.peak_bytes();
  return result;
}

}  // namespace gigabake::kernels
