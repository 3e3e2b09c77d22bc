/// What a shard's columns hold, in the order of the file, before anything is stored: of voxels, or of columns that
/// somebody else has made.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "format/shard/shard.h"
#include "format/shard/shard_layout.h"
#include "lattice/pack/packed_level.h"

namespace gigabake {

/// Borrows what it is given.
class ShardColumns {
 public:
  explicit ShardColumns(const ShardHeader& header) : header_(header) {}

  /// Nodes first, then what levels above are made of, then levels from lod 0 on.
  void add_nodes(const NodeTable& nodes);
  void add_nodes(const std::vector<PackedColumn>& nodes);
  void add_above(const ParentSource& above);
  /// Finds which voxels share a value; where the arrays do not fit each other they are stored as they
  /// are, for readers to refuse.
  void add_level(const BrickLevel& level, const ThreadPool& pool);
  void add_level(const PackedLevel& level);

  std::span<const ColumnRows> columns() const { return columns_; }

  /// stored: of each column.
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
  void add_channel(const ChannelColumns& names, const SharedValues& values);
  LevelColumns next_level();
  std::vector<VoxelChannel> channels() const;

  const ShardHeader& header_;
  std::deque<VoxelGroups> groups_;  ///< what is borrowed stays where it is
  std::deque<SharedValues> values_;
  std::vector<ColumnRows> columns_;
  std::vector<int> part_;  ///< of each column: its lod, of_nodes or of_above
  std::string group_;      ///< of the next column, where it is the first of it
  int next_part_ = of_nodes;
  int lods_ = 0;
};

}  // namespace gigabake
