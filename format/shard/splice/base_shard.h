/// A stored shard of which a new shard takes most bricks. Has its nodes, the masks of all bricks, and where the rows of
/// each brick begin. Values are read only where a caller requests them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/codec/packed_level.h"
#include "format/shard/hdf5/hdf5_rows.h"
#include "format/shard/levels/level_summary.h"
#include "format/shard/shard.h"
#include "format/shard/shard_pages.h"

namespace gigabake {

/// The number of rows before a brick: in the columns with a row per voxel, in `children` and in `facing`. counted_by()
/// is the index of a column's count.
using BrickRows = std::array<std::uint64_t, 3>;

/// One level of a base shard.
struct BaseLevel {
  std::vector<std::uint64_t> key;                                     ///< per brick, ascending
  BrickLevel bricks;                                                  ///< only masks and first voxels
  std::vector<BrickRows> before;                                      ///< bricks + 1 entries
  std::array<std::unique_ptr<Hdf5Rows>, level_column_count> columns;  ///< by LevelColumn; null: not stored
  AlphaCounts alphas = {};                                            ///< number of voxels with each alpha
};

class BaseShard {
 public:
  /// Reads the nodes, the downsample state, and the columns that state which voxels and rows exist.
  /// Cost    15 ns of one core per voxel, without the values of voxels.
  /// Errors  InputError: the shard is damaged, or of a version with other rows.
  BaseShard(const std::filesystem::path& path, const ThreadPool& pool);

  const ShardHeader& header() const { return pages_.header(); }
  const NodeTable& nodes() const { return nodes_; }
  const DownsampleState& above() const { return above_; }
  const BaseLevel& level(std::size_t lod) const { return levels_[lod]; }
  std::size_t lods() const { return levels_.size(); }
  /// Returns false if the rows of a level cannot be spliced. Then a voxel has no parent voxel, or all voxels of a level
  /// store their coverages. Bakes with max_error 0 have neither.
  bool is_spliceable() const { return is_spliceable_; }

  /// Returns consecutive bricks with all values. Thread-safe.
  /// Range   first + count ≤ level(lod).key.size(), and count ≤ ShardPages::max_bricks.
  BrickBlock bricks(int lod, std::uint64_t first, std::uint32_t count) const { return pages_.level(lod, first, count); }

 private:
  void read_masks(const ThreadPool& pool);
  void read_rows(int lod, const ThreadPool& pool);

  ShardPages pages_;
  Hdf5File file_;
  NodeTable nodes_;
  DownsampleState above_;
  std::vector<BaseLevel> levels_;
  bool is_spliceable_ = true;
};

}  // namespace gigabake
