/// The rules of a node table but for its keys, row by row: each row against all those before it, which a few numbers
/// stand for. So a walk can begin in the middle, where another one has passed.
#pragma once

#include <cstdint>

#include "format/shard/check/broken_rule.h"
#include "format/shard/shard.h"

namespace gigabake {

/// Everything that the rows before `row` say of it.
struct NodePlace {
  std::uint64_t row = 0;
  std::uint64_t level_end = 1;   ///< the row after the last of its level
  std::uint64_t next_child = 1;  ///< the row of the next child
  std::uint64_t next_brick = 0;  ///< the next brick's number in this level
  std::uint32_t lod = 0;
};

/// Levels stand from the root down, a level's rows are the children of the level above, in order and without gaps.
/// Bricks of a level are numbered in order. Leaf-constant nodes and those of level 0 have no children, others have.
/// Errors  All members throw InputError naming `path`, the row and the rule.
class NodeWalk {
 public:
  /// From the root. Borrows `path`.
  NodeWalk(const std::filesystem::path& path, const ShardHeader& header, std::uint64_t rows);
  /// From a place where a walk through the same table has been.
  NodeWalk(const std::filesystem::path& path, const NodePlace& place, std::uint64_t rows);

  const NodePlace& place() const { return place_; }

  /// first_child and value of the row at place().
  void check_links(NodeKind kind, std::uint8_t child_mask, std::uint32_t first_child, std::uint32_t value) const;
  /// Checks the rest of that row and goes on to the next. Where all rows have been passed, the table is whole.
  void step(std::uint32_t lod, NodeKind kind, std::uint8_t child_mask);

 private:
  BrokenRule table_;
  NodePlace place_;
  std::uint64_t rows_;
};

}  // namespace gigabake
