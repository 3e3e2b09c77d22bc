/// One oct-tree of the GigaVoxels lineage, as the thesis's viewer holds it: blocks of 2×2×2 nodes, bricks by number.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/shard/shard.h"

namespace gigabake {

/// How gradients are stored: (n + 1) · 127.5 of each component, rounded; 128 is 0.
using GradientBytes = std::array<std::uint8_t, 3>;
GradientBytes gradient_bytes(const std::int8_t oct[2]);
inline constexpr GradientBytes no_gradient{128, 128, 128};

/// The attributes of a tree, in the order in which a tree file has them.
struct GigavoxelHeader {
  std::uint32_t max_depth = 0;            ///< number of levels; the root has depth 0
  std::array<double, 3> corner_m{};       ///< lowest corner, scene frame
  std::array<double, 3> delta_m{};        ///< edge of a voxel of the deepest level
  std::array<std::uint32_t, 3> volume{};  ///< voxels of the deepest level on each axis
  std::array<std::uint32_t, 3> brick{};   ///< voxels of a brick without its border
};

struct GigavoxelNode {
  bool is_constant = true;
  std::uint32_t child_block = 0;  ///< 0: no children
  std::uint32_t value = 0;  ///< number of the brick in its depth's file; constant: r, g, b, a from the lowest byte
  GradientBytes gradient = no_gradient;  ///< of constant nodes
};

/// Block b is nodes [8b, 8b + 8): child x + 2y + 4z. Block 0 has the root in its first node and seven empty ones.
/// Nodes without a voxel are constant and transparent (value 0).
struct GigavoxelTree {
  GigavoxelHeader header;
  std::vector<GigavoxelNode> nodes;
};

/// The levels of one shard from its own level `lod` on, breadth first. Bricks keep the numbers that they have in their
/// level. Errors  InputError: more blocks than a node can name (2^30).
GigavoxelTree gigavoxel_tree(const ShardHeader& cell, const NodeTable& nodes, int lod);

}  // namespace gigabake
