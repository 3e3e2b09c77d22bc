/// A stream of one device, and marks in it.
#pragma once

#include <cuda_runtime.h>

#include "kernels/cuda/memory.cuh"

namespace gigabake::kernels {

struct Stream {
  cudaStream_t handle = nullptr;

  explicit Stream(int device) {
    check_cuda(cudaSetDevice(device), "cudaSetDevice");
    check_cuda(cudaStreamCreateWithFlags(&handle, cudaStreamNonBlocking), "cudaStreamCreate");
  }
  ~Stream() { cudaStreamDestroy(handle); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
};

/// How far a stream was when it was recorded.
class StreamMark {
 public:
  StreamMark() { check_cuda(cudaEventCreateWithFlags(&event_, cudaEventDisableTiming), "cudaEventCreate"); }
  ~StreamMark() { cudaEventDestroy(event_); }
  StreamMark(const StreamMark&) = delete;
  StreamMark& operator=(const StreamMark&) = delete;

  void record(cudaStream_t stream) { check_cuda(cudaEventRecord(event_, stream), "cudaEventRecord"); }
  /// Whether the device is beyond it, or was never asked to come there.
  bool is_reached() const {
    const cudaError_t answer = cudaEventQuery(event_);
    if (answer == cudaErrorNotReady) return false;
    check_cuda(answer, "cudaEventQuery");
    return true;
  }
  void wait() const { check_cuda(cudaEventSynchronize(event_), "cudaEventSynchronize"); }
  /// Where it is too late for errors.
  void wait_quietly() const { cudaEventSynchronize(event_); }

 private:
  cudaEvent_t event_ = nullptr;
};

}  // namespace gigabake::kernels
