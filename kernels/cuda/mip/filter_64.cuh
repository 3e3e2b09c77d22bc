/// Filter of MipFilter::thesis on the device. It computes a level from the level that is two levels finer.
#pragma once

#include <cstdint>

#include "kernels/cuda/mip/filter.cuh"
#include "kernels/cuda/mip/level_bricks.cuh"

namespace gigabake::kernels {

struct LevelOf64 {
  LevelView fine;  ///< the level that is two levels finer
  const std::uint32_t *key, *first;
  const std::uint64_t* mask;
  std::uint32_t bricks;
  VoxelsOut out;
};

/// Computes the voxels of a level.
/// Errors  CudaFailure.
void filter_level_of_64(DeviceHeap& heap, const LevelOf64& level, const Tables& tables);

}  // namespace gigabake::kernels
