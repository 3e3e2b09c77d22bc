/// A baked cell's way back to the host.
#pragma once

#include <span>
#include <vector>

#include "kernels/body/cell.h"
#include "kernels/cuda/levels.cuh"
#include "kernels/cuda/pinned.cuh"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// The largest level's colours, its normals, and the rest.
inline constexpr int download_threads = 3;

/// Levels and, where there are any, nodes: everything into `pinned`, then into the host's arrays, on the threads of
/// `pool`: most of the time goes into the first touch of new memory.
/// Errors  CudaFailure.
CellVolume to_host(cudaStream_t stream, PinnedBuffer& pinned, std::span<const DeviceLevel> levels,
                   const DeviceNodes& nodes, const ThreadPool& pool);

}  // namespace gigabake::kernels
