#include <algorithm>
#include <atomic>
#include <bit>
#include <deque>
#include <utility>

#include "format/shard/channels.h"
#include "format/shard/shard.h"
#include "format/shard/shard_layout.h"
#include "format/system/publish.h"

namespace gigabake {
namespace {

constexpr std::size_t bricks_per_check = 8192;

void write_header(Hdf5File& file, const ShardHeader& h) {
  const auto u32 = [&](const char* name, std::uint32_t v) { file.write_attribute(name, Hdf5Type::u32, &v, 0); };
  file.write_attribute("format", shard_format);
  file.write_attribute("version", Hdf5Type::i32, &shard_version, 0);
  file.write_attribute("generator", h.generator);
  file.write_attribute("cell", h.cell);
  file.write_attribute("lattice_min", Hdf5Type::i64, h.lattice_min.data(), 3);
  u32("cell_voxels", h.cell_voxels);
  file.write_attribute("voxel_size_m", Hdf5Type::f64, &h.voxel_size_m, 0);
  file.write_attribute("lattice_origin_m", Hdf5Type::f64, h.lattice_origin_m.data(), 3);
  u32("brick_edge", brick_edge);
  u32("lods", h.lods);
  if (h.origin) {
    const double origin[3] = {h.origin->latitude_deg, h.origin->longitude_deg, h.origin->height_m};
    file.write_attribute("origin", Hdf5Type::f64, origin, 3);
  }
  file.write_attribute("fingerprint", h.fingerprint.hex());
  std::string hashes;
  for (const Hash128& hash : h.content_hash) hashes += (hashes.empty() ? "" : " ") + hash.hex();
  file.write_attribute("content_hash", hashes);
  file.write_attribute("channels", channel_names(h.has_normals, h.has_facing));
  file.write_attribute("triangles", Hdf5Type::u64, &h.triangles, 0);
}

/// What a reader will demand. Where it does not hold the arrays are written as they stand, for readers to refuse.
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

/// What a shard's columns hold, in their order, before anything is packed. Borrows the shard.
class ShardColumns {
 public:
  ShardColumns(const Shard& shard, const ThreadPool& pool) : shard_(shard), pool_(pool) {
    add_nodes();
    for (std::size_t lod = 0; lod < shard.levels.size(); ++lod) add_level(shard.levels[lod], int(lod));
  }

  std::span<const ColumnRows> columns() const { return columns_; }

  /// stored: of each column.
  StoredShard stored_bytes(const std::vector<std::uint64_t>& stored) const {
    StoredShard out;
    out.levels.resize(shard_.levels.size());
    for (std::size_t c = 0; c < columns_.size(); ++c)
      if (lod_[c] != of_nodes) out.levels[std::size_t(lod_[c])] += stored[c];
    return out;
  }

 private:
  static constexpr int of_nodes = -1;

  void add(const Hdf5Column& column, std::uint64_t rows, decltype(ColumnRows::get) get) {
    columns_.push_back({std::exchange(group_, {}), column, rows, std::move(get)});
    lod_.push_back(now_);
  }

  /// As many rows as `values` fill.
  template <class T>
  void add_array(const Hdf5Column& column, const std::vector<T>& values) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(values.data());
    const std::size_t row = column.row_bytes();
    add(column, values.size() * sizeof(T) / row, [bytes, row](std::uint64_t first, std::uint64_t count, auto&) {
      return std::span(bytes + first * row, count * row);
    });
  }

  void add_nodes() {
    const NodeColumns names(shard_version);
    const NodeTable& n = shard_.nodes;
    group_ = "/nodes";
    add_array(names.key, n.key);
    add_array(names.lod, n.lod);
    add_array(names.kind, n.kind);
    add_array(names.child_mask, n.child_mask);
    add_array(names.first_child, n.first_child);
    add_array(names.value, n.value);
    add_array(names.normal, n.normal);
    if (shard_.header.has_facing) add_array(names.facing, n.facing);
  }

  void add_level(const BrickLevel& level, int lod) {
    const std::vector<VoxelChannel> channels = stored_channels(shard_version, shard_.header, lod);
    const LevelColumns names(lod);
    now_ = lod;
    group_ = names.group;
    add_array(names.mask, level.mask);
    add_array(names.first, level.first);
    const bool consistent = is_consistent(level, channels, pool_);
    if (consistent) groups_.push_back(group_voxels(level.mask, level.first, pool_));
    for (const VoxelChannel& channel : channels) {
      const auto bytes = bytes_of(channel, level);
      if (consistent)
        values_.emplace_back(groups_.back(), level.first, bytes, channel.width, pool_);
      else
        values_.emplace_back(bytes, channel.width, array_bytes(channel, level) / bytes.stride);
      add_channel({names.group, channel}, values_.back());
    }
  }

  void add_channel(const ChannelColumns& names, const SharedValues& values) {
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

  const Shard& shard_;
  const ThreadPool& pool_;
  std::deque<VoxelGroups> groups_;  ///< what is borrowed stays where it is
  std::deque<SharedValues> values_;
  std::vector<ColumnRows> columns_;
  std::vector<int> lod_;  ///< of each column, or of_nodes
  std::string group_;     ///< of the next column, where it is the first of it
  int now_ = of_nodes;
};

}  // namespace

StoredShard write_shard(const std::filesystem::path& path, const Shard& shard, const ShardWriteOptions& options) {
  Publication publication(path);
  StoredShard stored;
  {
    Hdf5File file = Hdf5File::create(publication.aside(), path);
    write_header(file, shard.header);
    const ShardColumns columns(shard, options.pool);
    stored = columns.stored_bytes(file.write_columns(columns.columns(), options.codec, options.pool));
    file.close();
  }
  stored.file = std::filesystem::file_size(publication.aside());
  publication.publish();
  return stored;
}

}  // namespace gigabake
