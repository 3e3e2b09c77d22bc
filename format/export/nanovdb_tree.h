/// The tree of a NanoVDB grid: which nodes there are, in the order in which its file has them.
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "format/export/nanovdb_layout.h"
#include "format/scene/scene_level.h"

namespace gigabake {

/// Orders leaves as a breadth-first grid does. Edges of leaf, lower and upper node: 8, 128, 4096 voxels.
struct NanovdbLeafKey {
  std::uint64_t root = 0;   ///< key of the root's tile
  std::uint32_t upper = 0;  ///< child number in the upper node
  std::uint16_t lower = 0;  ///< child number in the lower node
  friend auto operator<=>(const NanovdbLeafKey&, const NanovdbLeafKey&) = default;
};

/// Of the block of 8³ voxels. Range  indices of 32 bits.
NanovdbLeafKey nanovdb_leaf_key(const LevelIndex& lowest);

/// An inner node: its children are a run of the nodes below.
struct NanovdbInnerNode {
  std::uint32_t first_child = 0, children = 0;
  nanovdb_layout::IndexBox box;  ///< of its voxels
};

/// 16 bytes a leaf (48 while they are added), and 32 an inner node: what of an export grows with the scene.
class NanovdbTree {
 public:
  /// A block that has voxels, any number of times.
  void add(const LevelIndex& lowest) { leaves_.push_back(nanovdb_leaf_key(lowest)); }
  /// After the last.
  void finish();

  std::span<const NanovdbLeafKey> leaves() const { return leaves_; }
  std::span<const NanovdbInnerNode> lower() const { return lower_; }
  std::span<const NanovdbInnerNode> upper() const { return upper_; }
  const nanovdb_layout::IndexBox& box() const { return box_; }

  /// Number of a block that was added; of any other, leaves().size().
  std::uint32_t leaf(const LevelIndex& lowest) const;
  /// Widens the boxes above a leaf.
  void widen(std::uint32_t leaf, const nanovdb_layout::IndexBox& box);

 private:
  std::vector<NanovdbLeafKey> leaves_;
  std::vector<NanovdbInnerNode> lower_, upper_;
  nanovdb_layout::IndexBox box_;
};

}  // namespace gigabake
