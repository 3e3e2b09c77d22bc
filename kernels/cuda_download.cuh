/// A baked cell's way back to the host.
#pragma once

#include <cstddef>
#include <vector>

#include "kernels/cell.h"
#include "kernels/cuda_levels.cuh"
#include "kernels/policy.h"

namespace gigabake::kernels {

/// Page-locked host memory, which a device writes to at the speed of its link. Grows, and is kept.
class PinnedBuffer {
 public:
  PinnedBuffer() = default;
  ~PinnedBuffer();
  PinnedBuffer(const PinnedBuffer&) = delete;
  PinnedBuffer& operator=(const PinnedBuffer&) = delete;

  /// Errors  CudaFailure.
  std::byte* reserve(std::size_t bytes);

 private:
  std::byte* data_ = nullptr;
  std::size_t bytes_ = 0;
};

/// Levels and, where there are any, nodes: everything into `pinned`, then into the host's arrays, on the threads of
/// `policy`: most of the time goes into the first touch of new memory.
/// Errors  CudaFailure.
CellVolume to_host(cudaStream_t stream, PinnedBuffer& pinned, const std::vector<DeviceLevel>& levels,
                   const DeviceNodes& nodes, const CpuPolicy& policy);

}  // namespace gigabake::kernels
