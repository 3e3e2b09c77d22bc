/// The contents of a shard's columns in file order, for the writer. The contents are voxel arrays, or columns that are
/// packed already.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/codec/packed_level.h"
#include "format/shard/columns/level_differences.h"
#include "format/shard/shard.h"
#include "format/shard/shard_layout.h"

namespace gigabake {

class SplicedRows;  // format/shard/splice/spliced_rows.h

/// List of a shard's columns. Borrows its inputs.
class ShardColumns {
 public:
  explicit ShardColumns(const ShardHeader& header) : header_(header) {}

  /// Adds the nodes. Call the add functions in this order: nodes, downsample state, levels from lod 0.
  void add_nodes(const NodeTable& nodes);
  void add_nodes(const std::vector<PackedColumn>& nodes);
  void add_above(const DownsampleState& above);
  /// Adds all levels.
  /// Errors  InputError naming the cell and the level: its arrays do not match each other.
  void add_levels(const NodeTable& nodes, const std::vector<BrickLevel>& levels, const ThreadPool& pool);
  /// Adds the next level, whose chunks are partly packed already.
  void add_level(const SplicedRows& level);
  /// Adds the next level.
  void add_level(const PackedLevel& level);

  std::span<const ColumnRows> columns() const { return columns_; }

  /// Returns the sizes of the levels and nodes in bytes. `stored` has the size of each column.
  StoredShard stored_bytes(const std::vector<std::uint64_t>& stored) const;

 private:
  static constexpr int of_nodes = -1, of_above = -2;

  void add(const Hdf5Column& column, std::uint64_t rows, decltype(ColumnRows::get) get) {
    columns_.push_back({std::exchange(group_, {}), column, rows, std::move(get)});
    part_.push_back(next_part_);
  }
  template <class T>
  void add_array(const Hdf5Column& column, const std::vector<T>& values);
  void add_bytes(const Hdf5Column& column, std::uint64_t rows, const std::uint8_t* bytes);
  void add_packed(const Hdf5Column& column, const PackedColumn& packed);
  void add_level(const LevelDifferences& level);
  void begin_level();

  const ShardHeader& header_;
  std::deque<LevelDifferences> levels_;  ///< a deque: elements are borrowed and must not move
  std::vector<ColumnRows> columns_;
  std::vector<int> part_;  ///< per column: its lod, of_nodes or of_above
  std::string group_;      ///< HDF5 group to create before the next column; empty: none
  int next_part_ = of_nodes;
  int lods_ = 0;
};

}  // namespace gigabake
