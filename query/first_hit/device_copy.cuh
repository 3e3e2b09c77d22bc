/// Copies of arrays between host and device, for both casters of first hits.
#pragma once

#include "core/base/host_device.h"
#include "kernels/cuda/device/memory.cuh"
#include "kernels/cuda/device/stream.cuh"

namespace gigabake::kernels {

/// Starts a copy of `host` to `device`. `call` names the copy in the message of a CudaFailure.
template <class T>
void copy_to_device(T* device, const Span<const T>& host, cudaStream_t stream, const char* call) {
  check_cuda(cudaMemcpyAsync(device, host.data, host.size * sizeof(T), cudaMemcpyHostToDevice, stream), call);
}

}  // namespace gigabake::kernels
