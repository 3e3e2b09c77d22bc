/// A level in device memory.
#pragma once

#include <cstdint>

#include "core/octree/octree.h"
#include "kernels/cuda/device/memory.cuh"

namespace gigabake::kernels {

/// Level whose bricks are in Morton order. Voxels are ordered by brick, then by bit number in the brick's mask.
struct DeviceLevel {
  DeviceArray<std::uint32_t> key, first;           ///< `first` has bricks + 1 elements
  DeviceArray<std::uint64_t> mask;                 ///< 8 per brick
  DeviceArray<std::uint32_t> rgba;                 ///< four bytes, red in the lowest
  DeviceArray<std::uint16_t> normal;               ///< two bytes per voxel, or empty
  DeviceArray<std::uint8_t> directional_coverage;  ///< directional_coverage_bytes per voxel, or empty
  std::uint32_t bricks = 0, voxels = 0;

  /// Returns the bytes of the level's content. Its arrays may be longer, because voxelization allocates spare voxels.
  std::uint64_t bytes() const {
    const std::uint64_t of_brick = sizeof(std::uint32_t) * 2 + sizeof(std::uint64_t) * 8,
                        of_voxel = sizeof(std::uint32_t) + (normal.empty() ? 0 : sizeof(std::uint16_t)) +
                                   (directional_coverage.empty() ? 0 : directional_coverage_bytes);
    return of_brick * bricks + of_voxel * voxels;
  }
};

}  // namespace gigabake::kernels
