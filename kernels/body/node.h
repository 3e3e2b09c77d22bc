/// The rules of a node table: which brick may be a constant node, where its children stand, how many nodes there are
/// at most.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>

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
