/// Stages 3 and 4 on the device: every brick's triangles become its voxels.
#pragma once

#include <cstdint>

#include "kernels/cuda/bin.cuh"

namespace gigabake::kernels {

/// Level, on the device: bricks in Morton order, voxels brick after brick by rising bit number.
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

/// What earlier cells had: the next one is given that much room, and tried again where it has more.
struct FillRatios {
  double voxels_per_pair = 5, items_per_pair = 2;
  double pairs_spread = 1, voxels_spread = 1;  ///< the fullest batch over the mean one
};

/// room_bytes: what the heap should hold at most; it decides how large batches are. lists: consumed. No brick of
/// the result is empty; no voxel of it invisible. Errors CudaFailure; DeviceFull beyond 2^32-1 voxels too.
DeviceLevel voxelize(DeviceHeap& heap, const InputView& input, std::uint64_t room_bytes, const WindowView& window,
                     BrickLists lists, bool normals, CellMaterials materials, FillRatios& ratios, CellStats& stats);

}  // namespace gigabake::kernels
