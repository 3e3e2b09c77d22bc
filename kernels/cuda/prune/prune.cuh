/// Device version of kernels/cpu's prune(): the node table of levels that may contain constant bricks.
#pragma once

#include <deque>
#include <vector>

#include "kernels/cuda/mip/levels.cuh"

namespace gigabake::kernels {

struct PrunedLevels {
  DeviceNodes nodes;
  std::vector<const DeviceLevel*> levels;  ///< by lod, each without constant bricks: an element of `made`, or an
                                           ///< unchanged input level
  std::deque<DeviceLevel> made;
  bool has_constants = false;  ///< true if constant bricks were removed from a level
};

/// Makes the node table of `levels` [lod] (at least one) and removes constant bricks' voxels. Borrows the levels and
/// does not change them.
/// Exact   Same nodes and levels as prune().
/// Cost    About 40 bytes of working memory per brick, and a copy of every level that has a constant brick. Waits for
///         the stream once.
/// Errors  DeviceFull, CudaFailure; std::length_error for 2^32-1 nodes or more.
PrunedLevels prune_levels(DeviceHeap& heap, const std::vector<DeviceLevel>& levels);

}  // namespace gigabake::kernels
