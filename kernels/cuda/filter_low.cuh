/// Levels 1 to 4 on the device, in one go: what lies in a brick of lod 1 is one voxel of lod 4, and a block makes all
/// of it, so that rasters of lods 1 to 3 never leave the block.
#pragma once

#include "kernels/cuda/filter.cuh"
#include "kernels/cuda/level_bricks.cuh"
#include "lattice/rules.h"

namespace gigabake::kernels {

inline constexpr int most_low_levels = 4;

struct LowLevel {
  const std::uint64_t* mask;
  const std::uint32_t* first;
  VoxelsOut out;
};

struct LowLevels {
  LevelView fine;  ///< lod 0
  LowLevel level[most_low_levels];
  int levels;                        ///< 1…4, from lod 1 on
  const std::uint32_t *key, *start;  ///< of lod 1
  const Ancestors* ancestors;
  std::uint32_t bricks;  ///< of lod 1
  MipFilter filter;
  std::uint32_t* rasters;  ///< of the last level; null without MipFilter::coverage
};

/// Fills the levels, and the last one's rasters.
/// Errors  CudaFailure.
void filter_low(DeviceHeap& heap, const LowLevels& levels, const Tables& tables);

}  // namespace gigabake::kernels
