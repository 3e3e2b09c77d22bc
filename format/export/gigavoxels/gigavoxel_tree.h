/// One octree of the GigaVoxels format, in the layout of the thesis's viewer: blocks of 2×2×2 nodes, and numbered
/// bricks.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math/vec3.h"
#include "format/shard/shard.h"

namespace gigabake {

/// The stored form of a gradient: (n + 1) · 127.5, rounded, for each component n of a unit vector. The byte 128 means
/// 0.
using GradientBytes = std::array<std::uint8_t, 3>;
GradientBytes gradient_bytes(const std::int8_t oct[2]);
inline constexpr GradientBytes no_gradient{128, 128, 128};

/// The attributes of a tree, in the order of a tree file.
struct GigavoxelHeader {
  std::uint32_t max_depth = 0;   ///< number of levels; the root has depth 0
  Vec3d corner_m{};              ///< lowest corner, scene frame
  Vec3d delta_m{};               ///< edge of a voxel of the deepest level
  Vec3<std::uint32_t> volume{};  ///< voxels of the deepest level on each axis
  Vec3<std::uint32_t> brick{};   ///< voxels of a brick on each axis, without its border
};

struct GigavoxelNode {
  bool is_constant = true;
  std::uint32_t child_block = 0;  ///< 0: no children
  std::uint32_t value = 0;        ///< brick number in the file of its depth; if constant: r, g, b, a, lowest byte first
  GradientBytes gradient = no_gradient;  ///< no_gradient if the node is not constant
};

/// The nodes of an octree in blocks of eight. Block b consists of nodes [8b, 8b + 8), in the order x + 2y + 4z. Block 0
/// holds the root in its first node and seven empty nodes. Nodes without a voxel are constant and transparent (value
/// 0).
struct GigavoxelTree {
  GigavoxelHeader header;
  std::vector<GigavoxelNode> nodes;
};

/// Converts levels [lod, cell.lods) of one shard, breadth first. Bricks keep their numbers within the level.
/// Errors  InputError: the tree has more blocks than a node can refer to (2^30).
GigavoxelTree gigavoxel_tree(const ShardHeader& cell, const NodeTable& nodes, int lod);

}  // namespace gigabake
