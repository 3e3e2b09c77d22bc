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
  int levels;                        ///< 1…4, beginning with lod 1
  const std::uint32_t *key, *start;  ///< of lod 1
  const Ancestors* ancestors;
  std::uint32_t bricks;  ///< of lod 1
  MipFilter filter;
  std::uint32_t* rasters;  ///< of the coarsest of these levels; null without MipFilter::coverage
};

/// Computes the voxels of the levels, and the coverage masks of the coarsest one.
/// Errors  CudaFailure.
void filter_low(DeviceHeap& heap, const LowLevels& levels, const Tables& tables);

}  // namespace gigabake::kernels
