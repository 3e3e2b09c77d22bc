/// Row-by-row check of a node table, except for its keys. A few numbers summarize all preceding rows, so a check can
/// resume in the middle, at a place that an earlier check has passed.
#pragma once

#include <cstdint>

#include "format/shard/check/broken_rule.h"
#include "format/shard/shard.h"

namespace gigabake {

/// The constraints that all rows before row `row` impose on row `row`.
struct NodePlace {
  std::uint64_t row = 0;
  std::uint64_t level_end = 1;   ///< the row after the last row of the current level
  std::uint64_t next_child = 1;  ///< the row of the next child
  std::uint64_t next_brick = 0;  ///< the number of the next brick on this level
  std::uint32_t lod = 0;

  /// Advances to the next row. `kind` and `child_mask` are the values of row `row`.
  void advance(NodeKind kind, std::uint8_t child_mask);
};

/// Checker of the order and links of a node table. Levels are ordered from the root down. The rows of a level are the
/// children of the next coarser level, in order and without gaps.
/// Bricks of a level are numbered in order. Leaf-constant nodes and nodes of level 0 have no children; every other node
/// has at least one child or leaf. Only levels from 1 to the header's leaf_lod have leaves.
/// Errors  InputError naming `path`, the row and the rule, from every member.
class NodeWalk {
 public:
  /// Starts at the root. Borrows `path`.
  NodeWalk(const std::filesystem::path& path, const ShardHeader& header, std::uint64_t rows);
  /// Starts at a place that an earlier check of the same table has passed.
  NodeWalk(const std::filesystem::path& path, const ShardHeader& header, const NodePlace& place, std::uint64_t rows);

  const NodePlace& place() const { return place_; }

  /// Checks first_child and value of the row at place().
  void check_links(NodeKind kind, std::uint8_t child_mask, std::uint32_t first_child, std::uint32_t value) const;
  /// Checks `lod`, `kind`, `child_mask` and `leaf_mask` of the row at place(), and advances to the next row. The order
  /// and links of the table are valid if all rows pass check_links() and step().
  void step(std::uint32_t lod, NodeKind kind, std::uint8_t child_mask, std::uint8_t leaf_mask);

 private:
  BrokenRule table_;
  NodePlace place_;
  std::uint64_t rows_;
  std::uint32_t end_of_leaves_;  ///< levels of the shard from 1 to this one, exclusive, may have leaves
};

}  // namespace gigabake
