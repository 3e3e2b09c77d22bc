/// The class of a voxel: the class with the largest weight in it. Content without a class counts as class 0. If weights
/// are equal, the lowest class wins.
///
/// Weight  At the level where triangles are voxelized, the clipped area of the fragments that are not fully
///         transparent. On coarser levels, the weight of a child in the filter of colours.
/// Exact   Integers: the order of fragments and children does not matter, and host and device return the same class.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/octree/octree.h"

namespace gigabake::kernels {

/// The class with the largest weight so far.
template <class Weight>
struct ClassMajority {
  Weight weight = 0;
  VoxelClass voxel_class = no_class;

  /// Adds the total weight of a class.
  GB_HD void add(VoxelClass other, Weight of_other) {
    if (of_other < weight || of_other == 0 || (of_other == weight && voxel_class <= other)) return;
    weight = of_other;
    voxel_class = other;
  }
};

/// Returns whether a fragment counts for the class of its voxel. `alpha` is Fragment::alpha.
GB_HD bool has_class_weight(std::uint16_t alpha) { return alpha != 0; }

/// Returns the class of a voxel with eight children. Children of weight 0 do not count.
/// Range   Weights are at most 255.
GB_HD VoxelClass class_of_children(const VoxelClass children[8], const std::uint32_t weights[8]) {
  ClassMajority<std::uint32_t> majority;
  for (int c = 0; c < 8; ++c) {
    std::uint32_t sum = 0;
    for (int other = 0; other < 8; ++other) sum += children[other] == children[c] ? weights[other] : 0;
    if (weights[c] != 0) majority.add(children[c], sum);
  }
  return majority.voxel_class;
}

}  // namespace gigabake::kernels
