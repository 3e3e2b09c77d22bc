/// Levels from 5 on, on the device: one after the other.
#pragma once

#include "kernels/cuda/filter.cuh"
#include "kernels/cuda/level_bricks.cuh"
#include "lattice/rules.h"

namespace gigabake::kernels {

struct HighLevel {
  LevelView fine;              ///< the level below
  const std::uint32_t* start;  ///< [brick]: its first child
  const std::uint32_t* first;
  const std::uint64_t* mask;
  std::uint32_t bricks;
  VoxelsOut out;
  const std::uint32_t* rasters_below;  ///< null without MipFilter::coverage, as is the next
  std::uint32_t* rasters;
  const Patch* patches_below;  ///< null without it or normals
  MipFilter filter;
};

/// Fills a level.
/// Errors  CudaFailure.
void filter_high(DeviceHeap& heap, const HighLevel& level, const Tables& tables);

}  // namespace gigabake::kernels
