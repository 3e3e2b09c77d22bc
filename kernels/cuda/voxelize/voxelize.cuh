/// Stages 3 and 4 of a bake on the device: computes every brick's voxels from its triangles.
#pragma once

#include <cstdint>

#include "kernels/cuda/mip/device_level.cuh"
#include "kernels/cuda/voxelize/bin.cuh"

namespace gigabake::kernels {

/// Ratios measured on earlier cells, which determine the sizes of the next cell's arrays. The arrays of a cell that
/// exceeds a ratio grow while it is filled.
struct FillRatios {
  double voxels_per_pair = 5, items_per_pair = 2;
  double pairs_spread = 1, voxels_spread = 1;  ///< ratio of the fullest batch to the mean batch
};

/// Computes the finest level. It has no empty brick and no invisible voxel. `capacity_bytes` is the intended max of the
/// heap's live bytes; it determines the size of batches. `lists` is consumed.
/// Errors  CudaFailure; DeviceFull, also beyond 2^32-1 voxels.
DeviceLevel voxelize(DeviceHeap& heap, const InputView& input, std::uint64_t capacity_bytes, const CellWindow& window,
                     BrickLists lists, const CellParameters& parameters, CellMaterials materials, FillRatios& ratios,
                     CellStats& stats);

}  // namespace gigabake::kernels
