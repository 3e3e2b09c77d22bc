/// Filter of levels 5 and coarser on the device, one level at a time.
#pragma once

#include "core/base/rules.h"
#include "kernels/cuda/mip/filter.cuh"
#include "kernels/cuda/mip/level_bricks.cuh"

namespace gigabake::kernels {

struct HighLevel {
  LevelView fine;              ///< the next finer level
  const std::uint32_t* start;  ///< [brick]: its first child
  const std::uint32_t* first;
  const std::uint64_t* mask;
  std::uint32_t bricks;
  VoxelsOut out;
  const std::uint32_t* rasters_below;  ///< null without MipFilter::coverage; so is `rasters`
  std::uint32_t* rasters;
  const SurfaceMoments* patches_below;  ///< null without MipFilter::coverage or normals
  MipFilter filter;
};

/// Computes the voxels of a level.
/// Errors  CudaFailure.
void filter_high(DeviceHeap& heap, const HighLevel& level, const Tables& tables);

}  // namespace gigabake::kernels
