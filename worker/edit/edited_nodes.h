/// The node table of a cell after edits of some of its bricks.
#pragma once

#include <cstdint>
#include <vector>

#include "core/octree/octree.h"
#include "worker/edit/edited_levels.h"
#include "worker/edit/stored_bricks.h"

namespace gigabake {

/// A node of one level.
struct EditedNode {
  std::uint64_t key;
  StoredNode node;
  /// The number of a brick in the stored level; no_stored_brick: of a new brick, or a constant node.
  std::uint32_t stored_brick;
};
inline constexpr std::uint32_t no_stored_brick = 0xffffffffu;

/// The nodes of all levels after edits.
struct EditedNodes {
  std::vector<std::vector<EditedNode>> levels;  ///< [lod]; by rising key

  /// Returns the node of a brick; null if the table has none.
  const EditedNode* find(std::size_t lod, std::uint64_t key) const;
  NodeTable table(const ShardHeader& header) const;
};

/// Returns the nodes by the rules of kernels/cpu/prune/prune.h. Bricks that are not in `edited` keep their nodes.
/// Bricks below an edited leaf-constant node become nodes.
EditedNodes edited_nodes(const BaseShard& base, const StoredBricks& stored, const std::vector<EditedLevel>& edited);

}  // namespace gigabake
