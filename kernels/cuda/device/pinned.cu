#include "core/base/trace.h"
#include "kernels/cuda/device/memory.cuh"
#include "kernels/cuda/device/pinned.cuh"

namespace gigabake::kernels {

PinnedBuffer::~PinnedBuffer() { cudaFreeHost(data_); }

std::byte* PinnedBuffer::reserve(std::size_t bytes) {
  if (bytes <= bytes_) return data_;
  const TraceSpan span("lock pages");
  check_cuda(cudaFreeHost(data_), "cudaFreeHost");
  data_ = nullptr;
  bytes_ = 0;
  check_cuda(cudaMallocHost(&data_, bytes), "cudaMallocHost");
  bytes_ = bytes;
  return data_;
}

}  // namespace gigabake::kernels
