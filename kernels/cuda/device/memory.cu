#include <algorithm>
#include <cstring>
#include <string>

#include "core/base/trace.h"
#include "kernels/cuda/device/memory.cuh"

namespace gigabake::kernels {
namespace {

constexpr std::chrono::microseconds long_step(200);  ///< shorter steps are left out of a trace

}  // namespace

void check_cuda(cudaError_t code, const char* call) {
  if (code == cudaSuccess) return;
  cudaGetLastError();  // clears the error, or the next call would report it again
  throw CudaFailure(std::string(call) + ": " + cudaGetErrorString(code));
}

void* DeviceHeap::take(std::size_t bytes) {
  if (limit_ != 0 && live_ + bytes > limit_)
    throw DeviceFull(std::to_string(live_ + bytes) + " bytes where " + std::to_string(limit_) + " are allowed");
  const TraceSpan span("allocate on the device", {}, long_step);
  void* data = nullptr;
  const cudaError_t code = cudaMallocAsync(&data, std::max<std::size_t>(bytes, 1), stream_);
  if (code == cudaErrorMemoryAllocation) {
    cudaGetLastError();
    throw DeviceFull("cudaMallocAsync: no " + std::to_string(bytes) + " bytes are left on the device");
  }
  check_cuda(code, "cudaMallocAsync");
  count_work(WorkCounter::device_allocations);
  live_ += bytes;
  memory_stats_.add(std::int64_t(bytes));
  return data;
}

void DeviceHeap::give(void* data, std::size_t bytes) noexcept {
  if (data == nullptr) return;
  const TraceSpan span("free on the device", {}, long_step);
  cudaFreeAsync(data, stream_);
  live_ -= bytes;
  memory_stats_.add(-std::int64_t(bytes));
}

void DeviceHeap::bring(void* host, const void* device, std::size_t bytes, const char* what) {
  std::byte* arrived = arrived_.reserve(bytes);
  download_async(arrived, device, bytes, stream_, what);
  wait_for(stream_, what);
  std::memcpy(host, arrived, bytes);
}

void upload_async(void* device, const void* host, std::size_t bytes, cudaStream_t stream, const char* what) {
  count_work(WorkCounter::device_bytes_uploaded, bytes);
  check_cuda(cudaMemcpyAsync(device, host, bytes, cudaMemcpyHostToDevice, stream), what);
}

void download_async(void* host, const void* device, std::size_t bytes, cudaStream_t stream, const char* what) {
  count_work(WorkCounter::device_bytes_downloaded, bytes);
  check_cuda(cudaMemcpyAsync(host, device, bytes, cudaMemcpyDeviceToHost, stream), what);
}

void wait_for(cudaStream_t stream, const char* what) {
  count_work(WorkCounter::device_synchronizations);
  const TraceSpan span("wait for the device", {}, long_step);
  check_cuda(cudaStreamSynchronize(stream), what);
}

void wait_for(cudaEvent_t event, const char* what) {
  count_work(WorkCounter::device_synchronizations);
  check_cuda(cudaEventSynchronize(event), what);
}

}  // namespace gigabake::kernels
