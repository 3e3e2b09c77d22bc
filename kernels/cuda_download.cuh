/// A baked cell's way back to the host.
#pragma once

#include <vector>

#include "kernels/cell.h"
#include "kernels/cuda_levels.cuh"
#include "kernels/cuda_pinned.cuh"
#include "kernels/policy.h"

namespace gigabake::kernels {

/// The largest level's colours, its normals, and the rest.
inline constexpr int download_threads = 3;

/// Levels and, where there are any, nodes: everything into `pinned`, then into the host's arrays, on the threads of
/// `policy`: most of the time goes into the first touch of new memory.
/// Errors  CudaFailure.
CellVolume to_host(cudaStream_t stream, PinnedBuffer& pinned, const std::vector<DeviceLevel>& levels,
                   const DeviceNodes& nodes, const CpuPolicy& policy);

}  // namespace gigabake::kernels
