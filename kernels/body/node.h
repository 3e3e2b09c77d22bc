/// The rules of a node table: which brick may be a constant node, where its children stand, how many nodes there are
/// at most.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "kernels/body/voxel.h"
#include "lattice/brick.h"
#include "lattice/host_device.h"
#include "lattice/octree.h"

namespace gigabake::kernels {

inline constexpr std::uint32_t no_child = 0xffffffffu;

/// Morton codes of a brick's parent in the level above, and of the brick among the parent's eight children.
GB_HD std::uint64_t parent_key(std::uint64_t key) { return key >> 3; }
GB_HD int octant_of(std::uint64_t key) { return int(key & 7); }

/// A brick with all of its voxels may be a constant node; one with fewer is not. first: as BrickLevel::first.
template <class Index>
GB_HD bool is_full(const Index first[2]) {
  return first[1] - first[0] == Index(brick_voxels);
}

/// A voxel, to be held against the others of its brick and of the branch below.
struct CommonVoxel {
  std::uint32_t rgba = 0, facing = 0;  ///< facing: at lod 0, and where levels have none, alpha along each axis
  std::uint16_t normal = 0;
};

/// facing: its bytes, or null where the level has none.
GB_HD CommonVoxel common_voxel(std::uint32_t rgba, std::uint16_t normal, const std::uint8_t* facing) {
  const std::uint32_t alpha = byte_of(rgba, 3);
  return {rgba, facing != nullptr ? pack_facing(facing) : alpha | alpha << 8 | alpha << 16, normal};
}

GB_HD bool are_alike(const CommonVoxel& a, const CommonVoxel& b) {
  return a.rgba == b.rgba && a.normal == b.normal && a.facing == b.facing;
}

/// is_constant: a full brick of which all voxels are alike.
GB_HD NodeKind kind_of_brick(bool is_constant) { return is_constant ? NodeKind::constant : NodeKind::brick; }
GB_HD bool stores_voxels(NodeKind kind) { return kind == NodeKind::brick; }
/// Nothing below it is stored.
GB_HD bool ends_branch(NodeKind kind) { return kind == NodeKind::leaf_constant; }
/// Of a constant node. like_all_below: all eight children are there, end their branches and are as the node is; at
/// lod 0 always.
GB_HD NodeKind kind_of_constant(bool like_all_below) {
  return like_all_below ? NodeKind::leaf_constant : NodeKind::constant;
}

/// What a node's row says of its own: bricks have voxels instead, and nodes of levels without facing have none.
GB_HD CommonVoxel value_of_node(NodeKind kind, const CommonVoxel& voxel, bool has_facing) {
  if (stores_voxels(kind)) return {};
  return {voxel.rgba, has_facing ? voxel.facing : 0, voxel.normal};
}

/// A node's children stand one behind the other, by rising key.
struct NodeChildren {
  std::uint32_t first = no_child;
  std::uint8_t mask = 0;  ///< bit c: child c is stored

  /// Call by rising key.
  GB_HD void add(std::uint32_t node, std::uint64_t key) {
    if (mask == 0) first = node;
    mask = std::uint8_t(mask | 1u << octant_of(key));
  }
};

/// What a table says besides of `count` nodes that are all bricks.
inline void set_all_bricks(NodeTable& nodes, std::size_t count) {
  nodes.kind.assign(count, NodeKind::brick);
  nodes.normal.assign(count, {});
  nodes.facing.assign(count, {});
}

/// Errors  std::length_error beyond 2^32-1 nodes.
inline void check_node_count(std::uint64_t nodes) {
  if (nodes >= no_child) throw std::length_error("an oct-tree of more than 2^32-1 nodes; use a smaller `cell_voxels`");
}

}  // namespace gigabake::kernels
