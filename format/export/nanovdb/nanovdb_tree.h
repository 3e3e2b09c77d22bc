/// The tree of a NanoVDB grid: its nodes in the order of the file.
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "format/export/nanovdb/nanovdb_layout.h"
#include "format/scene/scene_level.h"

namespace gigabake {

/// The sort key of leaves in a breadth-first grid. A leaf has an edge of 8 voxels, a lower node of 128, and an upper
/// node of 4096.
struct NanovdbLeafKey {
  std::uint64_t root = 0;   ///< key of the tile in the root
  std::uint32_t upper = 0;  ///< child number in the upper node
  std::uint16_t lower = 0;  ///< child number in the lower node
  friend auto operator<=>(const NanovdbLeafKey&, const NanovdbLeafKey&) = default;
};

/// Returns the key of the block of 8³ voxels whose lowest voxel is `lowest`.
/// Range   Indices fit into 32 bits.
NanovdbLeafKey nanovdb_leaf_key(const LevelIndex& lowest);

/// An inner node. Its children are consecutive nodes of the level below.
struct NanovdbInnerNode {
  std::uint32_t first_child = 0, children = 0;
  nanovdb_layout::IndexBox box;  ///< bounds of the node's voxels
};

/// The nodes of a tree.
/// Cost    16 bytes per leaf (48 while leaves are added) and 32 per inner node. The other memory of an export does not
///         grow with the scene.
class NanovdbTree {
 public:
  /// Adds a block that has voxels. The same block may be added several times.
  void add(const LevelIndex& lowest) { leaves_.push_back(nanovdb_leaf_key(lowest)); }
  /// Builds the tree. Call it after the last add().
  void finish();

  std::span<const NanovdbLeafKey> leaves() const { return leaves_; }
  std::span<const NanovdbInnerNode> lower() const { return lower_; }
  std::span<const NanovdbInnerNode> upper() const { return upper_; }
  const nanovdb_layout::IndexBox& box() const { return box_; }

  /// Returns the index of the leaf at `lowest`, or leaves().size() if this block was not added.
  std::uint32_t leaf(const LevelIndex& lowest) const;
  /// Extends the boxes of the ancestors of leaf `leaf` so that they contain `box`.
  void widen(std::uint32_t leaf, const nanovdb_layout::IndexBox& box);

 private:
  std::vector<NanovdbLeafKey> leaves_;
  std::vector<NanovdbInnerNode> lower_, upper_;
  nanovdb_layout::IndexBox box_;
};

}  // namespace gigabake
