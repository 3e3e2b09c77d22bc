#include "format/shard/channels.h"
#include "format/shard/packed_shard.h"
#include "format/shard/shard.h"
#include "format/shard/shard_columns.h"
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

/// Writes aside whatever columns `add_columns` gives, and publishes.
template <class AddColumns>
StoredShard write_file(const std::filesystem::path& path, const ShardHeader& header, const ShardWriteOptions& options,
                       const AddColumns& add_columns) {
  Publication publication(path);
  StoredShard stored;
  {
    Hdf5File file = Hdf5File::create(publication.aside(), path);
    write_header(file, header);
    ShardColumns columns(header);
    add_columns(columns);
    stored = columns.stored_bytes(file.write_columns(columns.columns(), options.codec, options.pool));
    file.close();
  }
  stored.file = std::filesystem::file_size(publication.aside());
  publication.publish();
  return stored;
}

}  // namespace

StoredShard write_shard(const std::filesystem::path& path, const Shard& shard, const ShardWriteOptions& options) {
  return write_file(path, shard.header, options, [&](ShardColumns& columns) {
    columns.add_nodes(shard.nodes);
    for (const BrickLevel& level : shard.levels) columns.add_level(level, options.pool);
  });
}

StoredShard write_packed_shard(const std::filesystem::path& path, const PackedShard& shard,
                               const ShardWriteOptions& options) {
  return write_file(path, shard.header, options, [&](ShardColumns& columns) {
    columns.add_nodes(shard.nodes);
    for (const PackedLevel& level : shard.levels) columns.add_level(level);
  });
}

}  // namespace gigabake
