/// Stages 3 and 4 on the device: computes every brick's voxels from its triangles.
#pragma once

#include <cstdint>

#include "kernels/cuda/mip/device_level.cuh"
#include "kernels/cuda/voxelize/bin.cuh"

namespace gigabake::kernels {

/// Ratios measured on earlier cells, which size the arrays of the next one. A cell that exceeds them is retried.
struct FillRatios {
  double voxels_per_pair = 5, items_per_pair = 2;
  double pairs_spread = 1, voxels_spread = 1;  ///< fullest batch over the mean batch
};

/// Computes the finest level. It has no empty brick and no invisible voxel.
/// room_bytes: intended max live bytes of the heap, which decides the size of batches. lists: consumed.
/// Errors  CudaFailure; DeviceFull, also beyond 2^32-1 voxels.
DeviceLevel voxelize(DeviceHeap& heap, const InputView& input, std::uint64_t room_bytes, const CellWindow& window,
                     BrickLists lists, bool normals, CellMaterials materials, FillRatios& ratios, CellStats& stats);

}  // namespace gigabake::kernels
