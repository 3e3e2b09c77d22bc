/// Expansion of leaves: voxels of a coarser level that describe a level become voxels of that level.
#pragma once

#include <cstdint>
#include <vector>

#include "format/shard/shard.h"

namespace gigabake {

/// Adds the leaves of coarser levels to level `lod` of a shard, as the bricks and leaf-constant nodes that they
/// represent. `levels` are the shard's levels from `lod` on, `level` is a copy of the first. The result lists voxels,
/// but is no tree: its nodes have no children, and only nodes that represent voxels of the level. Directional coverage
/// is dropped.
/// Exact   Each leaf becomes the 8^n voxels of its cube, with its values.
void expand_leaves(const std::vector<BrickLevel>& levels, int lod, NodeTable& nodes, BrickLevel& level);

/// Returns the number of voxels of level `lod` that leaves of coarser levels represent. `above` are the shard's levels
/// from lod + 1 on.
std::uint64_t voxels_of_leaves(const NodeTable& nodes, const std::vector<BrickLevel>& above, int lod);

}  // namespace gigabake
