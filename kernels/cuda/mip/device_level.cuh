/// A level in device memory.
#pragma once

#include <cstdint>

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

  std::uint64_t bytes() const {
    return key.bytes() + first.bytes() + mask.bytes() + rgba.bytes() + normal.bytes() + directional_coverage.bytes();
  }
};

}  // namespace gigabake::kernels
