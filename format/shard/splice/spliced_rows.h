/// The rows of a level that takes most bricks of a stored shard, and replaces the others.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "format/shard/columns/level_differences.h"
#include "format/shard/splice/base_shard.h"
#include "format/shard/splice/recent_chunks.h"

namespace gigabake {

/// Consecutive bricks of a spliced level.
struct SplicedBricks {
  bool is_new = false;      ///< of SplicedLevel::bricks; else of the base shard
  std::uint64_t first = 0;  ///< number of the first one in its level
  std::uint64_t count = 0;
};

/// The new bricks of a level, and the order of new and stored bricks.
struct SplicedLevel {
  BrickLevel bricks;                 ///< the new bricks, by rising key
  std::vector<BrickParent> parents;  ///< of the new bricks; `value` counts the new bricks of the level above
  std::vector<SplicedBricks> runs;   ///< all bricks of the level, by rising key
};

/// The columns of a spliced level.
class SplicedRows {
 public:
  /// Borrows all arguments. `above` is the next coarser level; null: the level is the coarsest. `threads` is the number
  /// of threads that call collect(), which is fastest in the order of the rows.
  SplicedRows(const SplicedLevel& level, const SplicedLevel* above, const BaseLevel& base, bool has_coverage,
              int threads);

  /// Reads the chunks that can be copied as stored: their rows are the rows of one chunk of the base.
  /// Errors  InputError: a chunk of the base is damaged.
  void read_chunks(LevelColumn column);

  std::uint64_t rows(LevelColumn column) const;
  /// Returns rows [first, first + count) in `scratch`. Thread-safe.
  void collect(LevelColumn column, std::uint64_t first, std::uint64_t count, std::vector<std::uint8_t>& scratch) const;
  /// Returns the chunks that read_chunks() read; the others are empty.
  std::span<const std::span<const std::uint8_t>> copied_chunks(LevelColumn column) const {
    return spans_[std::size_t(column)];
  }
  std::uint64_t copied_bytes() const;

 private:
  /// Consecutive rows of a column of the base, or of the new bricks.
  struct Rows {
    bool is_new;
    std::uint64_t first, begin, end;  ///< first row there; rows of the new column
  };
  std::vector<Rows> rows_of(std::size_t counted) const;
  std::vector<std::uint64_t> starts() const;
  static void read_chunks(const Rows& run, std::uint64_t all, const Hdf5Rows& stored,
                          std::vector<std::vector<std::uint8_t>>& chunks);

  const SplicedLevel& level_;
  const BaseLevel& base_;
  std::array<std::unique_ptr<RecentChunks>, level_column_count> recent_;  ///< of the columns of the base
  LevelDifferences differences_;
  std::array<std::vector<Rows>, 3> rows_;  ///< by counted_by()
  std::vector<std::uint64_t> starts_;      ///< the column `first`
  std::array<std::vector<std::vector<std::uint8_t>>, level_column_count> chunks_;
  std::array<std::vector<std::span<const std::uint8_t>>, level_column_count> spans_;  ///< of chunks_
};

}  // namespace gigabake
