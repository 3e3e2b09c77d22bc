#include <algorithm>
#include <string>

#include "kernels/cuda_memory.cuh"

namespace gigabake::kernels {

void check_cuda(cudaError_t code, const char* call) {
  if (code == cudaSuccess) return;
  cudaGetLastError();  // an error that stays is reported again by the next call
  throw CudaFailure(std::string(call) + ": " + cudaGetErrorString(code));
}

void* DeviceHeap::take(std::size_t bytes) {
  void* data = nullptr;
  check_cuda(cudaMallocAsync(&data, std::max<std::size_t>(bytes, 1), stream_), "cudaMallocAsync");
  live_ += bytes;
  peak_ = std::max(peak_, live_);
  return data;
}

void DeviceHeap::give(void* data, std::size_t bytes) noexcept {
  if (data != nullptr) cudaFreeAsync(data, stream_);
  live_ -= bytes;
}

}  // namespace gigabake::kernels
