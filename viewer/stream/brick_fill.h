/// What the pools of the ray caster hold, made from stored voxels: which nodes there are in a tree of fields, and
/// bricks with the lowest layers of their upper neighbours as a border, across cells too.
#pragma once

#include <cstdint>

#include "kernels/cast/caster.h"
#include "viewer/light/shading.h"
#include "viewer/stream/cell_layout.h"
#include "viewer/stream/voxel_lookup.h"

namespace gigabake {

/// A node of a tree of fields.
struct FieldNode {
  std::uint32_t cell = 0;  ///< of the layout
  std::int32_t lod = 0;
  std::uint32_t at[3] = {0, 0, 0};  ///< place in its level, in bricks from the cell's corner

  FieldNode child(unsigned octant) const {
    return {cell, lod - 1, {2 * at[0] + (octant & 1), 2 * at[1] + (octant >> 1 & 1), 2 * at[2] + (octant >> 2 & 1)}};
  }
};

/// The node's own voxels, without the border.
kernels::VoxelBox box_of(const FieldNode& node, const CellLayout& layout);

/// Which of the node's eight children exist, where gaps.missing stays empty; some may turn out to be empty.
/// Range  node.lod > 0.
std::uint8_t children_of(const FieldNode& node, const CellLayout& layout, const VoxelLookup& lookup, PageGaps& gaps);

/// Fills the brick; false where all of its field is zero. Of use where gaps.missing stays empty.
bool fill_brick(const FieldNode& node, const CellLayout& layout, const VoxelLookup& lookup, const Shading& shading,
                PageGaps& gaps, kernels::CastBrick& brick);

}  // namespace gigabake
