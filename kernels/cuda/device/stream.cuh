/// Owner of a CUDA stream of one device.
#pragma once

#include <cuda_runtime.h>

#include "kernels/cuda/device/memory.cuh"

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

}  // namespace gigabake::kernels
