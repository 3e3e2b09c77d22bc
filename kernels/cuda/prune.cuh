/// prune() of kernels/cpu on the device: the node table of levels some brick of which may be constant.
#pragma once

#include <deque>
#include <vector>

#include "kernels/cuda/levels.cuh"

namespace gigabake::kernels {

struct PrunedLevels {
  DeviceNodes nodes;
  std::vector<const DeviceLevel*> levels;  ///< [lod], without constant bricks: one of `made`, or as it was
  std::deque<DeviceLevel> made;
  bool has_constants = false;  ///< of the nodes
};

/// levels: [lod], one at least; they stay as they are, and are borrowed.
/// Exact   The nodes and levels that prune() makes.
/// Cost    Some 40 bytes of working memory a brick, and once more every level that has a constant brick. Waits for the
///         stream once.
/// Errors  DeviceFull, CudaFailure; std::length_error beyond 2^32-1 nodes.
PrunedLevels prune_levels(DeviceHeap& heap, const std::vector<DeviceLevel>& levels);

}  // namespace gigabake::kernels
