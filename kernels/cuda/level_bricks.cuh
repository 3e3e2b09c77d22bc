/// Which bricks each coarser level has, where its voxels stand, and what is above and below each: everything but what
/// the voxels say.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/cuda/device_level.cuh"

namespace gigabake::kernels {

/// What of a level is read while others are made of it.
struct LevelView {
  const std::uint32_t *key, *first;
  const std::uint64_t* mask;
  const std::uint32_t* rgba;
  const std::uint16_t* normal;  ///< or null
  std::uint32_t bricks;
};

inline LevelView view_of(const DeviceLevel& l) {
  return {l.key.data(), l.first.data(), l.mask.data(), l.rgba.data(), l.normal.empty() ? nullptr : l.normal.data(),
          l.bricks};
}

/// The bricks of lods 2, 3 and 4 that a brick of lod 1 lies in.
struct Ancestors {
  std::uint32_t brick[3];
};

struct CoarserBricks {
  std::vector<DeviceLevel> levels;                 ///< from lod 1 on; voxels are counted, but not there yet
  std::vector<DeviceArray<std::uint32_t>> starts;  ///< [level][brick]: its first child, a brick of the level below
  DeviceArray<Ancestors> ancestors;                ///< of each brick of lod 1, as far as there are levels
};

/// The bricks of the levels [1, lods).
/// Exact   Keys and masks depend on those of `finest` alone. From lod 3 on a voxel is a brick three levels below.
/// Cost    Reads the keys three times, the masks of lod 0 once; waits for the stream twice.
/// Errors  CudaFailure.
CoarserBricks coarser_bricks(DeviceHeap& heap, const DeviceLevel& finest, int lods);

}  // namespace gigabake::kernels
