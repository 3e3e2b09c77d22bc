/// Stages 3 and 4 on the device: every brick's triangles become its voxels.
#pragma once

#include <cstdint>

#include "kernels/cuda/bin.cuh"
#include "kernels/cuda/device_level.cuh"

namespace gigabake::kernels {

/// What earlier cells had: the next one is given that much room, and tried again where it has more.
struct FillRatios {
  double voxels_per_pair = 5, items_per_pair = 2;
  double pairs_spread = 1, voxels_spread = 1;  ///< the fullest batch over the mean one
};

/// room_bytes: what the heap should hold at most; it decides how large batches are. lists: consumed. No brick of
/// the result is empty; no voxel of it invisible. Errors CudaFailure; DeviceFull beyond 2^32-1 voxels too.
DeviceLevel voxelize(DeviceHeap& heap, const InputView& input, std::uint64_t room_bytes, const CellWindow& window,
                     BrickLists lists, bool normals, CellMaterials materials, FillRatios& ratios, CellStats& stats);

}  // namespace gigabake::kernels
