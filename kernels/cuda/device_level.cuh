/// A level as the device holds it, until it is downloaded.
#pragma once

#include <cstdint>

#include "kernels/cuda/memory.cuh"

namespace gigabake::kernels {

/// Bricks in Morton order, voxels brick after brick by rising bit number.
struct DeviceLevel {
  DeviceArray<std::uint32_t> key, first;  ///< first: bricks + 1
  DeviceArray<std::uint64_t> mask;        ///< 8 per brick
  DeviceArray<std::uint32_t> rgba;        ///< four bytes, red lowest
  DeviceArray<std::uint16_t> normal;      ///< two bytes, or empty
  DeviceArray<std::uint8_t> facing;       ///< three a voxel, or empty
  std::uint32_t bricks = 0, voxels = 0;

  std::uint64_t bytes() const {
    return key.bytes() + first.bytes() + mask.bytes() + rgba.bytes() + normal.bytes() + facing.bytes();
  }
};

}  // namespace gigabake::kernels
