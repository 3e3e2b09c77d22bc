/// Rules of a node table: constant nodes, the order of children, and the max number of nodes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "core/base/host_device.h"
#include "core/octree/brick.h"
#include "core/octree/octree.h"
#include "kernels/body/voxel.h"

namespace gigabake::kernels {

inline constexpr std::uint32_t no_child = 0xffffffffu;

/// Returns the Morton code of a brick's parent in the next coarser level.
GB_HD std::uint64_t parent_key(std::uint64_t key) { return key >> 3; }
/// Returns a brick's index among its parent's eight children.
GB_HD int octant_of(std::uint64_t key) { return int(key & 7); }

/// Returns true if all 512 voxels of a brick exist. Only a full brick may be a constant node. `first` points to the
/// brick's entry in BrickLevel::first.
template <class Index>
GB_HD bool is_full(const Index first[2]) {
  return first[1] - first[0] == Index(brick_voxels);
}

/// Values of a voxel by which it is compared with other voxels of its brick and with the brick's descendants.
struct CommonVoxel {
  std::uint32_t rgba = 0,
                directional_coverage = 0;  ///< alpha along each axis if the voxel stores neither coverages nor a plane
  std::uint16_t normal = 0;
  VoxelClass voxel_class = no_class;
};

/// Returns the values of a voxel. `directional_coverage` points to its directional coverage; it is null if the level
/// has none.
GB_HD CommonVoxel common_voxel(std::uint32_t rgba, std::uint16_t normal, const std::uint8_t* directional_coverage,
                               VoxelClass voxel_class = no_class) {
  const std::uint32_t alpha = byte_of(rgba, 3),
                      stored = directional_coverage != nullptr ? pack_directional_coverage(directional_coverage) : 0;
  return {rgba, stored != 0 ? stored : alpha | alpha << 8 | alpha << 16, normal, voxel_class};
}

GB_HD bool are_equal(const CommonVoxel& a, const CommonVoxel& b) {
  return a.rgba == b.rgba && a.normal == b.normal && a.directional_coverage == b.directional_coverage &&
         a.voxel_class == b.voxel_class;
}

/// Returns the node type of a brick. `is_constant` is true if the brick is full and all its voxels are equal.
GB_HD NodeKind kind_of_brick(bool is_constant) { return is_constant ? NodeKind::constant : NodeKind::brick; }
GB_HD bool stores_voxels(NodeKind kind) { return kind == NodeKind::brick; }
/// Returns true if no node below this node is stored.
GB_HD bool ends_branch(NodeKind kind) { return kind == NodeKind::leaf_constant; }
/// Returns the type of a constant node. `like_all_below` is true if all eight children exist, end their branches and
/// equal the node. At lod 0 it is always true.
GB_HD NodeKind kind_of_constant(bool like_all_below) {
  return like_all_below ? NodeKind::leaf_constant : NodeKind::constant;
}

/// Returns the value that a node's row stores. Bricks store voxels instead, and nodes of levels without directional
/// coverage store none.
GB_HD CommonVoxel value_of_node(NodeKind kind, const CommonVoxel& voxel, bool has_directional_coverage) {
  if (stores_voxels(kind)) return {};
  return {voxel.rgba, has_directional_coverage ? voxel.directional_coverage : 0, voxel.normal, voxel.voxel_class};
}

/// Children of a node, stored consecutively in ascending order of their keys.
struct NodeChildren {
  std::uint32_t first = no_child;
  std::uint8_t mask = 0;  ///< bit c: child c is stored

  /// Adds a child. Call in ascending order of keys.
  GB_HD void add(std::uint32_t node, std::uint64_t key) {
    if (mask == 0) first = node;
    mask = std::uint8_t(mask | 1u << octant_of(key));
  }
};

/// Fills the table's columns other than the children for `count` nodes that are all bricks.
inline void set_all_bricks(NodeTable& nodes, std::size_t count) {
  nodes.kind.assign(count, NodeKind::brick);
  nodes.normal.assign(count, {});
  nodes.directional_coverage.assign(count, {});
}

/// Checks the number of nodes.
/// Errors  std::length_error for 2^32-1 nodes or more, because no_child is 2^32-1.
inline void check_node_count(std::uint64_t nodes) {
  if (nodes >= no_child) throw std::length_error("an oct-tree of more than 2^32-1 nodes; use a smaller `cell_voxels`");
}

}  // namespace gigabake::kernels
