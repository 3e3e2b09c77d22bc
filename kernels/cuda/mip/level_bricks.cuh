/// Bricks of the coarser levels, the indices of their voxels, and their parents and children: everything except the
/// voxels' values.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/cuda/mip/device_level.cuh"

namespace gigabake::kernels {

/// The arrays of a level that are read to compute coarser levels.
struct LevelView {
  const std::uint32_t *key, *first;
  const std::uint64_t* mask;
  const std::uint32_t* rgba;
  const std::uint16_t* normal;               ///< null if the level has none
  const std::uint8_t* directional_coverage;  ///< null if the level has none
  std::uint32_t bricks;
};

inline LevelView view_of(const DeviceLevel& l) {
  return {l.key.data(),
          l.first.data(),
          l.mask.data(),
          l.rgba.data(),
          l.normal.empty() ? nullptr : l.normal.data(),
          l.directional_coverage.empty() ? nullptr : l.directional_coverage.data(),
          l.bricks};
}

/// The bricks of lods 2, 3 and 4 that contain a brick of lod 1.
struct Ancestors {
  std::uint32_t brick[3];
};

struct CoarserBricks {
  std::vector<DeviceLevel> levels;                 ///< of lods 1 and coarser; voxels are counted but not allocated
  std::vector<DeviceArray<std::uint32_t>> starts;  ///< [level][brick]: its first child, a brick of the next finer level
  DeviceArray<Ancestors> ancestors;                ///< per brick of lod 1; only entries of existing levels are set
};

/// Computes the bricks of the levels [1, lods).
/// Exact   Keys and masks depend only on the keys and masks of `finest`. A voxel of lod 3 or coarser exists if there is
///         a brick three levels finer with the same cube.
/// Cost    Reads the keys three times and the masks of lod 0 once; waits for the stream twice.
/// Errors  CudaFailure.
CoarserBricks coarser_bricks(DeviceHeap& heap, const DeviceLevel& finest, int lods);

}  // namespace gigabake::kernels
