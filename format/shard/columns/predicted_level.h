/// One level of an open shard since version 7, decoded by ranges of bricks (docs/format.md, "Differences").
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "core/codec/packed_level.h"
#include "format/shard/columns/parent_voxels.h"
#include "format/shard/columns/stored_rows.h"

namespace gigabake {

/// The indices of the counts in a row of the column `first`.
inline constexpr std::size_t of_voxels = 0, of_children = 1, of_facing = 2;
/// Returns the index of the count that states the rows of a column.
/// Range   Not the column `first`.
constexpr std::size_t counted_by(LevelColumn column) {
  return column == LevelColumn::children ? of_children : column == LevelColumn::facing ? of_facing : of_voxels;
}

class PredictedLevel {
 public:
  /// Borrows `source`. `bricks` is the number of the level's bricks in the node table.
  /// Cost    Opens the column `first`. Each other column is opened at its first use.
  /// Errors  InputError: the column `first` does not match `bricks`. Also the errors of ColumnSource::open().
  PredictedLevel(const ColumnSource& source, const ShardHeader& header, int lod, std::uint64_t bricks);

  std::uint64_t bricks() const { return bricks_; }
  std::uint64_t voxels() const { return totals_[0]; }

  /// The values that read() decodes.
  enum class Values : std::uint8_t {
    all,
    predictions,  ///< masks, colours and normals, from which finer levels are predicted; alphas are 0
    masks,        ///< only masks and first voxels; bricks of `above` need no more than these
  };

  /// Decodes consecutive bricks, starting at `begin`. `parents` has their parents; bricks among them are in `above`.
  /// Thread-safe.
  /// Range   `begin` is a multiple of bricks_per_start; begin + parents.size() ≤ bricks().
  /// Errors  InputError naming the dataset, and the row or brick that breaks a rule. Checks the numbers of rows of the
  ///         columns that it uses; Values::all uses all.
  BrickLevel read(std::uint64_t begin, std::span<const BrickParent> parents, const SomeBricks& above,
                  Values values) const;

 private:
  /// A row of the column `first`: rows in the columns with a row per voxel, in `children` and in `facing`.
  using Starts = std::array<std::uint64_t, 3>;
  /// The bricks that are decoded, with the results so far.
  struct Range;

  /// A column that is opened at its first use.
  struct Column {
    bool is_stored = false;
    std::mutex opening;                ///< guards `rows`
    std::unique_ptr<StoredRows> rows;  ///< null: not opened yet
  };

  /// Returns a stored column. Opens it at the first call and checks its number of rows.
  const StoredRows& rows(LevelColumn column) const;
  bool has(LevelColumn column) const { return columns_[std::size_t(column)].is_stored; }
  void check_all_columns() const;
  template <class T>
  std::vector<T> read_rows(LevelColumn column, std::uint64_t first, std::uint64_t count) const;
  std::vector<Starts> read_starts(std::uint64_t begin, std::uint64_t bricks) const;
  const Starts* starts_at(const Range& range, std::size_t brick) const;
  std::string name(LevelColumn column) const;
  void expect(bool holds, LevelColumn column, std::uint64_t row, const char* rule) const;

  void read_masks(Range& range) const;
  void read_values(Range& range) const;
  void read_coverages(Range& range) const;
  void add_differences(Range& range) const;

  const ColumnSource& source_;
  int lod_;
  std::uint64_t bricks_;
  mutable std::array<Column, level_column_count> columns_;  ///< by LevelColumn
  Starts totals_ = {};
  bool is_dense_ = false, is_complete_ = false;  ///< as in LevelDifferences
};

}  // namespace gigabake
