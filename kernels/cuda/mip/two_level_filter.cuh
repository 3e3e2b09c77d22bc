/// Filter of MipFilter::thesis on the device. It computes a level from the level that is two levels finer.
#pragma once

#include <cstdint>

#include "kernels/cuda/mip/filter.cuh"
#include "kernels/cuda/mip/level_bricks.cuh"

namespace gigabake::kernels {

struct TwoLevelFilter {
  LevelView fine;  ///< the level that is two levels finer
  const std::uint32_t *key, *first;
  const std::uint64_t* mask;
  std::uint32_t bricks;
  VoxelsOut out;
};

/// Computes the voxels of a level.
/// Errors  CudaFailure.
void two_level_filter_level(DeviceHeap& heap, const TwoLevelFilter& level, const Tables& tables);

}  // namespace gigabake::kernels
