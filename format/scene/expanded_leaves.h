/// Expansion of leaves: voxels of a coarser level that describe a level become voxels of that level.
#pragma once

#include <cstdint>
#include <vector>

#include "format/scene/xml/scene_xml.h"
#include "format/shard/levels/leaf_walk.h"
#include "format/shard/shard.h"

namespace gigabake {

/// Returns the shape of a scene's leaves: planes if `depth_error` of its bake ended branches.
/// Errors  InputError: the scene has leaves, and its parameters cannot be read.
LeafShape leaf_shape_of(const SceneHeader& scene);

/// Adds the leaves of coarser levels to level `lod` of a shard, as the bricks and leaf-constant nodes that they
/// represent. `levels` are the shard's levels from `lod` on, `level` is a copy of the first. The result lists voxels,
/// but is no tree: its nodes have no children, and only nodes that represent voxels of the level. Directional coverage
/// is dropped.
/// Exact   Each leaf becomes the voxels that it describes, with its values: the 8^n voxels of its cube, or those that
///         its plane crosses.
void expand_leaves(const std::vector<BrickLevel>& levels, int lod, LeafShape shape, NodeTable& nodes,
                   BrickLevel& level);

/// Returns the number of voxels of level `lod` that leaves of coarser levels represent. `above` are the shard's levels
/// from lod + 1 on.
std::uint64_t voxels_of_leaves(const NodeTable& nodes, const std::vector<BrickLevel>& above, int lod, LeafShape shape);

}  // namespace gigabake
