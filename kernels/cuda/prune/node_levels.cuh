/// All bricks of a cell as a tree, from which nodes are made.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/body/prune/node.h"
#include "kernels/body/voxelize/window.h"
#include "kernels/cuda/mip/device_level.cuh"

namespace gigabake::kernels {

/// All levels by lod. An item is the number of a brick among the bricks of all levels, in the order of nodes: coarsest
/// level first.
struct NodeLevels {
  const std::uint32_t *key[max_levels], *first[max_levels];
  std::uint32_t bricks[max_levels], offset[max_levels];
  int count;

  __device__ int lod_of(std::uint32_t item) const {
    int lod = count - 1;
    while (item - offset[lod] >= bricks[lod]) --lod;
    return lod;
  }

  /// Calls visit(item, key) for each child of a brick in ascending order of keys. Bricks of lod 0 have no children.
  template <class Visit>
  __device__ void for_each_child(int lod, std::uint32_t brick_key, const Visit& visit) const {
    if (lod == 0) return;
    const std::uint32_t *below_key = key[lod - 1], below_bricks = bricks[lod - 1];
    std::uint32_t low = 0, high = below_bricks;  // binary search for the first child
    while (low < high) {
      const std::uint32_t middle = (low + high) / 2;
      if (parent_key(below_key[middle]) < brick_key)
        low = middle + 1;
      else
        high = middle;
    }
    for (; low < below_bricks && parent_key(below_key[low]) == brick_key; ++low)
      visit(offset[lod - 1] + low, below_key[low]);
  }
};

/// Numbers the items of all levels and returns their count.
/// Errors  std::length_error for 2^32-1 nodes or more.
inline std::uint32_t place_levels(const std::vector<DeviceLevel>& levels, NodeLevels& out) {
  std::uint64_t items = 0;
  out.count = int(levels.size());
  for (std::size_t l = levels.size(); l-- > 0;) {
    out.key[l] = levels[l].key.data();
    out.first[l] = levels[l].first.data();
    out.bricks[l] = levels[l].bricks;
    out.offset[l] = std::uint32_t(items);
    items += levels[l].bricks;
  }
  check_node_count(items);
  return std::uint32_t(items);
}

}  // namespace gigabake::kernels
