/// Construction of trees for first-hit rays: from nodes with positions, and by dilation of another tree.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "core/math/vec3.h"
#include "query/first_hit/first_hit_tree.h"

namespace gigabake {

/// The nodes of a tree, built from the leaves up. The children of level 0 nodes are voxels.
class FirstHitTreeBuilder {
 public:
  /// A position in voxels from the tree's lowest corner.
  using Position = Vec3i64;

  explicit FirstHitTreeBuilder(int bits);

  /// Adds a node of level 0. `at` is the node's position in nodes of level 0 from the tree's lowest corner.
  void add(const std::array<std::int32_t, 3>& at, const kernels::FirstHitNode& node);

  /// Fills the voxels of [low, high) with the largest nodes that fit; the coordinates are multiples of four.
  /// `attributes_index` is the index of the first of 64 equal attributes.
  void add_constant(const Position& low, const Position& high, std::uint32_t attributes_index);

  /// Returns the nodes: the root, then the nodes of each level in order, starting with the lowest level.
  /// Errors  std::length_error: 2^32 nodes or more.
  std::vector<kernels::FirstHitNode> finish();

 private:
  struct Entry {
    std::uint64_t key;  ///< six bits per level: the child's index in its parent
    kernels::FirstHitNode node;
  };

  void fill(const Position& at, std::size_t level, const Position& low, const Position& high,
            std::uint32_t attributes_index);
  kernels::FirstHitNode full_node(std::size_t level, std::uint32_t attributes_index);

  std::vector<std::vector<Entry>> levels_;
  std::vector<kernels::FirstHitNode> nodes_;
  /// The 64 equal children of each full node, by attributes and level.
  std::map<std::pair<std::uint32_t, std::size_t>, std::uint32_t> full_children_;
};

/// Returns a coarser, dilated tree with an edge of 2^(bits - 2 level) voxels. Its voxels are the children of the nodes
/// of `level`, and the 26 neighbours of each child. The attribute indices of its nodes are meaningless.
/// Range   No voxel touches a face of the cube.
std::vector<kernels::FirstHitNode> make_shell(const std::vector<kernels::FirstHitNode>& nodes, int bits, int level);

}  // namespace gigabake
