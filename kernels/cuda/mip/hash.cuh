/// Content hashes of levels on the device.
#pragma once

#include <vector>

#include "core/math/vec3.h"
#include "core/octree/voxel_hash.h"
#include "kernels/cuda/mip/device_level.cuh"

namespace gigabake::kernels {

/// Returns the same hashes as level_hashes() on the host. Waits for the stream.
/// Errors  CudaFailure.
std::vector<Hash128> level_hashes(DeviceHeap& heap, const std::vector<DeviceLevel>& levels, const Vec3i64& window_min);

}  // namespace gigabake::kernels
