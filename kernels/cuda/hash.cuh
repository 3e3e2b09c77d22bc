/// The content hash of levels on the device.
#pragma once

#include <vector>

#include "kernels/cuda/device_level.cuh"
#include "lattice/voxel_hash.h"

namespace gigabake::kernels {

/// As level_hashes(). Waits for the stream. Errors  CudaFailure.
std::vector<Hash128> level_hashes(DeviceHeap& heap, const std::vector<DeviceLevel>& levels,
                                  const std::int64_t window_min[3]);

}  // namespace gigabake::kernels
