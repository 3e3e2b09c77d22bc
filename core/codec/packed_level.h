/// A level's columns, packed by a kernel or the host for the writer of the shard (docs/format.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/codec/matches.h"

namespace gigabake {

/// The form of a column's rows: their size, the size of the items that HDF5's shuffle filter separates, and the length
/// of deflate's matches. The value 1 of `shuffled_bytes` means that the column is not shuffled.
struct RowShape {
  std::size_t bytes, shuffled_bytes;
  std::uint32_t min_match_bytes = deflate::min_match;
};

/// The columns of a level in file order (docs/format.md).
enum class LevelColumn : std::uint8_t { first, children, rgb, alpha, normal, facing, plane, voxel_class };
inline constexpr std::size_t level_column_count = 8;

/// Deflate finds no useful short matches among differences, because literals of small numbers take few bits
/// (docs/experiments/bytes.md).
inline constexpr std::uint32_t min_match_of_differences = 12, min_match_of_alpha = 8;

/// Returns the shape of a column's rows. Rows of `first` have three numbers: the first row of a brick in the columns
/// with a row per voxel, in `children` and in `facing`.
constexpr RowShape row_of(LevelColumn column) {
  switch (column) {
    case LevelColumn::first:
      return {3 * sizeof(std::uint64_t), sizeof(std::uint64_t)};
    case LevelColumn::rgb:
      return {3, 3, min_match_of_differences};
    case LevelColumn::alpha:
      return {1, 1, min_match_of_alpha};
    case LevelColumn::normal:
      return {2, 1, min_match_of_differences};
    case LevelColumn::facing:
      return {3, 1, min_match_of_differences};
    case LevelColumn::voxel_class:
      return {2, 2};
    default:
      return {1, 1};
  }
}

/// The columns of a node table in file order, each with one row per node. Rows of `normal` and `directional_coverage`
/// are zero for nodes that are not constant. The column `directional_coverage` exists only if the shard has that
/// channel.
enum class NodeColumn : std::uint8_t { key, lod, kind, child_mask, first_child, value, normal, directional_coverage };

/// A column's bytes, borrowed. At most one of `raw` and `stored` is not empty.
struct PackedColumn {
  std::uint64_t rows = 0;
  std::span<const std::uint8_t> raw = {};  ///< the bytes of all rows
  /// The chunks in storage format: shuffled, compressed, with checksums.
  std::vector<std::span<const std::uint8_t>> stored = {};
};

struct PackedLevel {
  std::array<PackedColumn, level_column_count> columns = {};  ///< by LevelColumn
  std::array<std::uint64_t, 256> alphas = {};                 ///< number of voxels with each alpha

  PackedColumn& operator[](LevelColumn column) { return columns[std::size_t(column)]; }
  const PackedColumn& operator[](LevelColumn column) const { return columns[std::size_t(column)]; }
};

}  // namespace gigabake
