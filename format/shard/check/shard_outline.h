/// A summary of a node table. It allows checking any block of rows as strictly as the whole table, and finds the
/// parents of bricks, without the other columns in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/codec/prediction.h"
#include "format/shard/check/node_walk.h"
#include "format/shard/shard.h"

namespace gigabake {

class ShardOutline {
 public:
  static constexpr std::uint64_t rows_per_place = 4096;

  /// Keeps `kind` and `child_mask`: two bytes per node. `leaf_mask` is empty if the shard has no leaves.
  /// Errors  InputError: the columns break a rule of NodeWalk, or differ in length.
  ShardOutline(const std::filesystem::path& path, const ShardHeader& header, const std::vector<std::uint8_t>& lod,
               std::vector<NodeKind> kind, std::vector<std::uint8_t> child_mask,
               const std::vector<std::uint8_t>& leaf_mask);

  std::uint64_t rows() const { return rows_; }
  std::uint64_t bricks(int lod) const { return bricks_[std::size_t(lod)]; }
  /// Returns the last stored place at or before `row`.
  /// Range   row < rows().
  const NodePlace& place_before(std::uint64_t row) const { return places_[row / rows_per_place]; }

  /// Returns the parents of consecutive bricks of a level. `value` of a constant parent is its row.
  /// Range   begin + count ≤ bricks(lod).
  /// Cost    Visits up to rows_per_place rows before each of the first brick and its parent.
  std::vector<BrickParent> parents(int lod, std::uint64_t begin, std::uint64_t count) const;

 private:
  void advance(NodePlace& place) const { place.advance(kind_[place.row], child_mask_[place.row]); }
  std::uint64_t row_of_brick(int lod, std::uint64_t brick) const;
  NodePlace parent_of_row(std::uint64_t row) const;

  std::uint64_t rows_;
  std::vector<NodeKind> kind_;
  std::vector<std::uint8_t> child_mask_;
  std::vector<NodePlace> places_;      ///< the place of every rows_per_place-th row
  std::vector<std::uint64_t> bricks_;  ///< number of bricks per lod
};

}  // namespace gigabake
