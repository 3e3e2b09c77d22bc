/// Download of a baked cell to the host.
#pragma once

#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"
#include "kernels/cuda/device/pinned.cuh"
#include "kernels/cuda/mip/levels.cuh"

namespace gigabake::kernels {

/// One thread for the largest level's colours, one for its normals and one for the other arrays.
inline constexpr int download_threads = 3;

/// Copies the levels, and the nodes if there are any, through `pinned` to the host's arrays.
/// Cost    Page faults of new host memory take most of the time, so the threads of `pool` fill the arrays.
/// Errors  CudaFailure.
CellVolume to_host(cudaStream_t stream, PinnedBuffer& pinned, std::span<const DeviceLevel> levels,
                   const DeviceNodes& nodes, const ThreadPool& pool);

/// Appends the bricks of the levels of a part to the levels [lod] of the parts before it.
/// Cost    One copy on the host, out of `pinned`, if `out` has capacity for the part.
/// Errors  CudaFailure.
void append_to_host(cudaStream_t stream, PinnedBuffer& pinned, std::span<const DeviceLevel> levels,
                    const ThreadPool& pool, std::span<Level> out);

}  // namespace gigabake::kernels
