/// Trees for first-hit rays: from nodes whose places are known, and from another tree's, with all neighbours.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "kernels/cast/first_hit_tree.h"

namespace gigabake {

/// The nodes of a tree as it grows, from the leaves up. Level 0 are the nodes whose children are voxels.
class FirstHitTreeBuilder {
 public:
  /// In voxels from the tree's lowest corner.
  using Position = std::array<std::int64_t, 3>;

  explicit FirstHitTreeBuilder(int bits);

  /// A node of level 0. at: in such nodes.
  void add(const std::array<std::int32_t, 3>& at, const kernels::FirstHitNode& node);

  /// Every voxel of [low, high), which have multiples of four as coordinates, in the largest nodes that fit.
  /// look: the first of 64, alike.
  void add_constant(const Position& low, const Position& high, std::uint32_t look);

  /// The root first; else a level's nodes lie in order, behind those of the level below.
  /// Errors  std::length_error: 2^32 nodes or more.
  std::vector<kernels::FirstHitNode> finish();

 private:
  struct Entry {
    std::uint64_t key;  ///< six bits a level: the child's number in its parent
    kernels::FirstHitNode node;
  };

  void fill(const Position& at, std::size_t level, const Position& low, const Position& high, std::uint32_t look);
  kernels::FirstHitNode full_node(std::size_t level, std::uint32_t look);

  std::vector<std::vector<Entry>> levels_;
  std::vector<kernels::FirstHitNode> nodes_;
  /// By look and level: the 64 children, alike, of every full node.
  std::map<std::pair<std::uint32_t, std::size_t>, std::uint32_t> full_children_;
};

/// The tree of 2^(bits - 2 level) voxels an edge that has the children of the other's nodes of `level`, and the 26
/// neighbours of each, as voxels. Their looks mean nothing.
/// Range   No voxel lies at a face of the cube.
std::vector<kernels::FirstHitNode> make_shell(const std::vector<kernels::FirstHitNode>& nodes, int bits, int level);

}  // namespace gigabake
