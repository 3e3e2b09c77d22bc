/// Owners of a CUDA stream and of a CUDA event.
#pragma once

#include <cstdint>
#include <cuda_runtime.h>

#include "kernels/cuda/device/memory.cuh"

namespace gigabake::kernels {

/// The priority of a stream. Its kernels run before waiting kernels of streams with a lower priority.
enum class StreamPriority : std::uint8_t { normal, high };

struct Stream {
  cudaStream_t handle = nullptr;

  explicit Stream(int device, StreamPriority priority = StreamPriority::normal) {
    check_cuda(cudaSetDevice(device), "cudaSetDevice");
    int lowest = 0, highest = 0;
    check_cuda(cudaDeviceGetStreamPriorityRange(&lowest, &highest), "cudaDeviceGetStreamPriorityRange");
    check_cuda(cudaStreamCreateWithPriority(&handle, cudaStreamNonBlocking,
                                            priority == StreamPriority::high ? highest : lowest),
               "cudaStreamCreateWithPriority");
  }
  ~Stream() { cudaStreamDestroy(handle); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
};

/// An event of the current device, without times.
struct Event {
  cudaEvent_t handle = nullptr;

  Event() { check_cuda(cudaEventCreateWithFlags(&handle, cudaEventDisableTiming), "cudaEventCreate"); }
  ~Event() { cudaEventDestroy(handle); }
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;
};

}  // namespace gigabake::kernels
