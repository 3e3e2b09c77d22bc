/// Edits of a cell that is baked on the device. The edits are applied on the host, by the same code as without a
/// device, so that no rule exists twice.
#pragma once

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"
#include "kernels/cuda/device/pinned.cuh"
#include "kernels/cuda/mip/device_level.cuh"
#include "kernels/cuda/voxelize/bin.cuh"

namespace gigabake::kernels {

/// Replaces lod 0 of the bricks in `range` by its edited voxels. Waits for the stream.
/// Cost    Copies the level to the host and back; few cells have edits.
/// Errors  CudaFailure; DeviceFull, also beyond 2^32-1 voxels.
void edit_level(DeviceHeap& heap, PinnedBuffer& pinned, const LevelEdits& edits, KeyRange range, const ThreadPool& pool,
                DeviceLevel& level);

}  // namespace gigabake::kernels
