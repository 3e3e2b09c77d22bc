#include <algorithm>
#include <bit>

#include "format/shard/channels.h"
#include "format/shard/shard.h"
#include "format/shard/shard_layout.h"
#include "format/system/publish.h"

namespace gigabake {
namespace {

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

/// As many rows as `values` fill.
template <class T>
void write_rows(Hdf5File& file, const Hdf5Column& column, const std::vector<T>& values,
                const ShardWriteOptions& options) {
  file.write_column(column, values.data(), values.size() * sizeof(T) / column.row_bytes(), options.codec, options.pool);
}

void write_nodes(Hdf5File& file, const ShardHeader& header, const NodeTable& n, const ShardWriteOptions& options) {
  const NodeColumns columns(shard_version);
  file.make_group("/nodes");
  write_rows(file, columns.key, n.key, options);
  write_rows(file, columns.lod, n.lod, options);
  write_rows(file, columns.kind, n.kind, options);
  write_rows(file, columns.child_mask, n.child_mask, options);
  write_rows(file, columns.first_child, n.first_child, options);
  write_rows(file, columns.value, n.value, options);
  write_rows(file, columns.normal, n.normal, options);
  if (header.has_facing) write_rows(file, columns.facing, n.facing, options);
}

/// What a reader will demand. Where it does not hold the arrays are written as they stand, for readers to refuse.
bool is_consistent(const BrickLevel& level, const std::vector<VoxelChannel>& channels) {
  const std::size_t bricks = level.mask.size() / 8;
  if (level.mask.size() % 8 != 0 || level.first.size() != bricks + 1 || level.first[0] != 0) return false;
  for (std::size_t b = 0; b < bricks; ++b) {
    std::uint64_t voxels = 0;
    for (std::size_t w = 0; w < 8; ++w) voxels += std::uint64_t(std::popcount(level.mask[8 * b + w]));
    if (level.first[b + 1] != level.first[b] + voxels) return false;
  }
  return std::all_of(channels.begin(), channels.end(), [&](const VoxelChannel& channel) {
    return array_bytes(channel, level) == level.first.back() * bytes_a_voxel(channel.array);
  });
}

SharedValues unshared_values(const BrickLevel& level, const VoxelChannel& channel) {
  SharedValues out;
  const auto bytes = bytes_of(channel, level);
  for (std::size_t v = 0; v < array_bytes(channel, level) / bytes.stride; ++v)
    out.value.insert(out.value.end(), bytes[v], bytes[v] + channel.width);
  return out;
}

void write_channel(Hdf5File& file, const ChannelColumns& columns, const SharedValues& values,
                   const ShardWriteOptions& options) {
  write_rows(file, columns.value, values.value, options);
  if (values.share.empty()) return;
  write_rows(file, columns.share, values.share, options);
  write_rows(file, columns.first, values.first, options);
}

void write_level(Hdf5File& file, const BrickLevel& level, int lod, const std::vector<VoxelChannel>& channels,
                 const ShardWriteOptions& options) {
  const LevelColumns columns(lod);
  file.make_group(columns.group);
  write_rows(file, columns.mask, level.mask, options);
  write_rows(file, columns.first, level.first, options);
  const bool consistent = is_consistent(level, channels);
  const VoxelGroups groups = consistent ? group_voxels(level.mask, level.first, options.pool) : VoxelGroups{};
  for (const VoxelChannel& channel : channels)
    write_channel(file, {columns.group, channel},
                  consistent ? share_values(groups, level.first, bytes_of(channel, level), channel.width, options.pool)
                             : unshared_values(level, channel),
                  options);
}

}  // namespace

std::uint64_t write_shard(const std::filesystem::path& path, const Shard& shard, const ShardWriteOptions& options) {
  Publication publication(path);
  {
    Hdf5File file = Hdf5File::create(publication.aside(), path);
    write_header(file, shard.header);
    write_nodes(file, shard.header, shard.nodes, options);
    for (std::size_t lod = 0; lod < shard.levels.size(); ++lod)
      write_level(file, shard.levels[lod], int(lod), stored_channels(shard_version, shard.header, int(lod)), options);
    file.close();
  }
  const std::uint64_t bytes = std::filesystem::file_size(publication.aside());
  publication.publish();
  return bytes;
}

}  // namespace gigabake
