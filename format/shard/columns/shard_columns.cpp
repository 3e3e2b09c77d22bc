#include "format/shard/columns/shard_columns.h"

#include <algorithm>
#include <atomic>
#include <bit>

namespace gigabake {
namespace {

constexpr std::size_t bricks_per_check = 8192;

/// Returns whether level.first counts the mask bits and each channel has one entry per voxel. Readers reject a level
/// without this property.
bool is_consistent(const BrickLevel& level, const std::vector<VoxelChannel>& channels, const ThreadPool& pool) {
  const std::size_t bricks = level.mask.size() / 8;
  if (level.mask.size() % 8 != 0 || level.first.size() != bricks + 1 || level.first[0] != 0) return false;
  std::atomic<bool> fits{true};
  pool.parallel_for(bricks, bricks_per_check, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t b = begin; b < end; ++b) {
      std::uint64_t voxels = 0;
      for (std::size_t w = 0; w < 8; ++w) voxels += std::uint64_t(std::popcount(level.mask[8 * b + w]));
      if (level.first[b + 1] != level.first[b] + voxels) fits = false;
    }
  });
  return fits && std::all_of(channels.begin(), channels.end(), [&](const VoxelChannel& channel) {
           return array_bytes(channel, level) == level.first.back() * bytes_a_voxel(channel.array);
         });
}

}  // namespace

StoredShard ShardColumns::stored_bytes(const std::vector<std::uint64_t>& stored) const {
  StoredShard out;
  out.levels.resize(std::size_t(lods_));
  for (std::size_t c = 0; c < columns_.size(); ++c)
    if (part_[c] != of_above) (part_[c] == of_nodes ? out.nodes : out.levels[std::size_t(part_[c])]) += stored[c];
  return out;
}

void ShardColumns::add_bytes(const Hdf5Column& column, std::uint64_t rows, const std::uint8_t* bytes) {
  const std::size_t row = column.row_bytes();
  add(column, rows, [bytes, row](std::uint64_t first, std::uint64_t count, auto&) {
    return std::span(bytes + first * row, count * row);
  });
}

/// Adds all rows in `values`.
template <class T>
void ShardColumns::add_array(const Hdf5Column& column, const std::vector<T>& values) {
  add_bytes(column, values.size() * sizeof(T) / column.row_bytes(),
            reinterpret_cast<const std::uint8_t*>(values.data()));
}

void ShardColumns::add_packed(const Hdf5Column& column, const PackedColumn& packed) {
  add_bytes(column, packed.rows, packed.raw.data());
  columns_.back().stored = packed.stored;
}

void ShardColumns::add_nodes(const NodeTable& n) {
  group_ = "/nodes";
  NodeColumns(shard_version).for_each(header_, [&](const Hdf5Column& column, auto array) {
    add_array(column, n.*array);
  });
}

void ShardColumns::add_nodes(const std::vector<PackedColumn>& nodes) {
  group_ = "/nodes";
  const std::vector<Hdf5Column> all = NodeColumns(shard_version).all(header_);
  for (std::size_t c = 0; c < all.size(); ++c) add_packed(all[c], nodes.at(c));
}

void ShardColumns::add_above(const DownsampleState& above) {
  if (above.empty()) return;
  next_part_ = of_above;
  const DownsampleStateColumns names(int(header_.first_lod + header_.lods) - 1);
  group_ = "/above";
  add_array(names.place, above.place);
  add_array(names.rgba, above.rgba);
  if (!above.normal.empty()) add_array(names.normal, above.normal);
  if (!above.raster.empty()) add_array(names.raster, above.raster);
  if (!above.patch.empty()) add_array(names.patch, above.patch);
}

LevelColumns ShardColumns::next_level() {
  next_part_ = lods_;
  LevelColumns names(lods_++);
  group_ = names.group;
  return names;
}

std::vector<VoxelChannel> ShardColumns::channels() const { return stored_channels(shard_version, header_, lods_ - 1); }

void ShardColumns::add_level(const BrickLevel& level, const ThreadPool& pool) {
  const LevelColumns names = next_level();
  add_array(names.mask, level.mask);
  add_array(names.first, level.first);
  const bool consistent = is_consistent(level, channels(), pool);
  if (consistent) groups_.push_back(group_voxels(level.mask, level.first, pool));
  for (const VoxelChannel& channel : channels()) {
    const auto bytes = bytes_of(channel, level);
    if (consistent)
      values_.emplace_back(groups_.back(), level.first, bytes, channel.width, pool);
    else
      values_.emplace_back(bytes, channel.width, array_bytes(channel, level) / bytes.stride);
    add_channel({names.group, channel}, values_.back());
  }
}

void ShardColumns::add_channel(const ChannelColumns& names, const SharedValues& values) {
  const std::size_t width = names.value.row_bytes();
  add(names.value, values.count(),
      [&values, width](std::uint64_t first, std::uint64_t count, std::vector<std::uint8_t>& scratch) {
        scratch.resize(count * width);
        values.collect(first, scratch);
        return std::span<const std::uint8_t>(scratch);
      });
  if (values.share().empty()) return;
  add_array(names.share, values.share());
  add_array(names.first, values.first());
}

void ShardColumns::add_level(const PackedLevel& level) {
  const LevelColumns names = next_level();
  add_packed(names.mask, level.mask);
  add_packed(names.first, level.first);
  const std::vector<VoxelChannel> all = channels();
  for (std::size_t c = 0; c < all.size(); ++c) {
    const ChannelColumns of_channel(names.group, all[c]);
    const PackedChannel& packed = level.channels.at(c);
    add_packed(of_channel.value, packed.value);
    if (packed.share.rows == 0) continue;
    add_packed(of_channel.share, packed.share);
    add_packed(of_channel.first, packed.first);
  }
}

}  // namespace gigabake
