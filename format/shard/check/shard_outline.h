/// A summary of a node table. It allows checking any block of rows as strictly as the whole table, without the other
/// rows in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "format/shard/check/node_walk.h"
#include "format/shard/shard.h"

namespace gigabake {

class ShardOutline {
 public:
  static constexpr std::uint64_t rows_per_place = 4096;

  /// Reads the columns of the whole table but does not keep them.
  /// Errors  InputError: the columns break a rule of NodeWalk, or differ in length.
  ShardOutline(const std::filesystem::path& path, const ShardHeader& header, const std::vector<std::uint8_t>& lod,
               const std::vector<NodeKind>& kind, const std::vector<std::uint8_t>& child_mask);

  std::uint64_t rows() const { return rows_; }
  std::uint64_t bricks(int lod) const { return bricks_[std::size_t(lod)]; }
  /// Returns the last stored place at or before `row`.
  /// Range   row < rows().
  const NodePlace& place_before(std::uint64_t row) const { return places_[row / rows_per_place]; }

 private:
  std::uint64_t rows_;
  std::vector<NodePlace> places_;      ///< the place of every rows_per_place-th row
  std::vector<std::uint64_t> bricks_;  ///< number of bricks per lod
};

}  // namespace gigabake
