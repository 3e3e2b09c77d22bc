/// Filter of levels 1 to 4 on the device in one launch. A brick of lod 1 covers one voxel of lod 4. One block computes
/// all levels of such a brick, so coverage masks of lods 1 to 3 stay in shared memory.
#pragma once

#include "core/base/rules.h"
#include "kernels/cuda/mip/filter.cuh"
#include "kernels/cuda/mip/level_bricks.cuh"

namespace gigabake::kernels {

inline constexpr int max_low_levels = 4;

struct LowLevel {
  const std::uint64_t* mask;
  const std::uint32_t* first;
  VoxelsOut out;
};

struct LowLevels {
  LevelView fine;  ///< lod 0
  LowLevel level[max_low_levels];
  int levels;                        ///< number of levels from lod 1 on, 1…4
  const std::uint32_t *key, *start;  ///< per brick of lod 1: its Morton key, and its first child
  const Ancestors* ancestors;
  std::uint32_t bricks;  ///< number of lod-1 bricks
  MipFilter filter;
  std::uint32_t* rasters;  ///< coverage masks of the coarsest of these levels; null without MipFilter::coverage
};

/// Computes the voxels of the levels, and the coverage masks of the coarsest of these levels.
/// Errors  CudaFailure.
void filter_low(DeviceHeap& heap, const LowLevels& levels, const Tables& tables);

}  // namespace gigabake::kernels
