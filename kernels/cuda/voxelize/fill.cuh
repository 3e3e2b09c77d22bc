/// Kernels that compute the voxels of a batch's bricks from its items.
#pragma once

#include <cstdint>

#include "kernels/body/cell.h"
#include "kernels/cuda/voxelize/batch.cuh"

namespace gigabake::kernels {

/// The arrays of the finest level, which have no empty places.
struct FinestArrays {
  const std::uint32_t* first;  ///< [brick] its first voxel
  std::uint32_t* rgba;
  std::uint16_t* normal;   ///< null if the cell has no normals
  std::uint32_t* plane;    ///< null if lod-0 voxels have no planes
  std::uint32_t capacity;  ///< number of voxels
};

/// Fills the bricks of a batch. Does nothing if the batch does not fit.
void launch_fill(CellMaterials materials, const BatchView& view, cudaStream_t stream);
/// Moves a batch's voxels from the staging arrays to their places in the level and removes the empty places.
void launch_unstage(const BatchView& view, const FinestArrays& level, cudaStream_t stream);
/// Adds the batch's counts to the counts of the level. If the batch did not fit, stops all later batches instead.
void launch_finish(const BatchView& view, const FinestArrays& level, cudaStream_t stream);

}  // namespace gigabake::kernels
