#include "kernels/pack/column_bytes.cuh"

namespace gigabake::kernels {

std::shared_ptr<const void> bring_columns(DeviceHeap& heap, const DeviceArray<std::uint8_t>& raw,
                                          const std::vector<RawColumn>& columns, PinnedPool& pinned) {
  std::shared_ptr<PinnedBuffer> buffer = pinned.take();
  std::byte* arrived = buffer->reserve(roomy(raw.size()));
  check_cuda(cudaMemcpyAsync(arrived, raw.data(), raw.size(), cudaMemcpyDeviceToHost, heap.stream()),
             "cudaMemcpyAsync (columns)");
  check_cuda(cudaStreamSynchronize(heap.stream()), "cudaStreamSynchronize (columns)");
  for (const RawColumn& c : columns)
    c.column->raw = {reinterpret_cast<const std::uint8_t*>(arrived) + c.at, c.column->rows * c.shape.bytes};
  return buffer;
}

}  // namespace gigabake::kernels
