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
  books_.add(std::int64_t(bytes));
  return data;
}

void DeviceHeap::give(void* data, std::size_t bytes) noexcept {
  if (data != nullptr) cudaFreeAsync(data, stream_);
  books_.add(-std::int64_t(bytes));
}

}  // namespace gigabake::kernels
