/// Construction of the contents of the ray caster's pools from stored voxels: nodes and bricks. A brick includes a
/// border of the lowest layers of its upper neighbours, also across cells.
#pragma once

#include <array>
#include <cstdint>

#include "kernels/render/caster.h"
#include "viewer/light/shading.h"
#include "viewer/stream/cell_layout.h"
#include "viewer/stream/voxel_lookup.h"

namespace gigabake {

/// A node of a tree that rays traverse (kernels/marching/scene.h).
struct FieldNode {
  std::uint32_t cell = 0;  ///< index in CellLayout::cells
  std::int32_t lod = 0;
  Vec3<std::uint32_t> at{0, 0, 0};  ///< position in bricks of its level from the cell's corner

  FieldNode child(unsigned octant) const {
    return {cell, lod - 1, {2 * at[0] + (octant & 1), 2 * at[1] + (octant >> 1 & 1), 2 * at[2] + (octant >> 2 & 1)}};
  }
};

/// Returns the box of the node's own voxels, without the border.
kernels::VoxelBox box_of(const FieldNode& node, const CellLayout& layout);

/// Masks of a node's children. A child in neither mask is empty.
struct ChildMasks {
  std::uint8_t stored = 0;  ///< have voxels of their level in themselves, or any at their border
  std::uint8_t leaves = 0;  ///< coarser leaves describe them: the node's brick replaces them
};

/// Returns the node's children; some stored ones may turn out to be empty. The masks are valid only if
/// missing_pages.missing stays empty.
/// Range   node.lod > 0.
ChildMasks children_of(const FieldNode& node, const CellLayout& layout, const VoxelLookup& lookup,
                       MissingPages& missing_pages);

/// The pages that the runs of a brick name; null from the first unused index on. They are valid until the pager's next
/// pass.
using BrickPages = std::array<const Page*, kernels::max_brick_pages>;

/// Fills the brick; returns false if the brick and its border contain no voxels. If all voxels lie in few pages, the
/// brick has runs (kernels/pool/voxel_run.h) and `pages` are their pages. The result is valid only if
/// missing_pages.missing stays empty. The next call with `path` starts at the path of the last lookup.
bool fill_brick(const FieldNode& node, const CellLayout& layout, const VoxelLookup& lookup, const Shading& shading,
                NodePath& path, MissingPages& missing_pages, kernels::CastBrick& brick, BrickPages& pages);

/// Returns the columns of a page of bricks.
kernels::StoredVoxels voxels_of(const Page& page);

/// Replaces the runs of the brick with the voxels.
void copy_runs(const Shading& shading, const BrickPages& pages, kernels::CastBrick& brick);

}  // namespace gigabake
