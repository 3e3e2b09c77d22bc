
#include "format/channels.h"
#include "format/publish.h"
#include "format/shard.h"
#include "format/shard_layout.h"

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
  file.write_column(column, values.data(), values.size() * sizeof(T) / column.row_bytes(), options.codec,
                    options.threads);
}

void write_nodes(Hdf5File& file, const ShardHeader& header, const NodeTable& n, const ShardWriteOptions& options) {
  const NodeColumns columns;
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

void write_level(Hdf5File& file, const ShardHeader& header, const BrickLevel& level, int lod,
                 const ShardWriteOptions& options) {
  const LevelColumns columns(lod);
  file.make_group(columns.group);
  write_rows(file, columns.mask, level.mask, options);
  write_rows(file, columns.first, level.first, options);
  write_rows(file, columns.rgba, level.rgba, options);
  if (header.has_normals) write_rows(file, columns.normal, level.normal, options);
  if (header.has_facing && columns.has_facing) write_rows(file, columns.facing, level.facing, options);
}

}  // namespace

std::uint64_t write_shard(const std::filesystem::path& path, const Shard& shard, const ShardWriteOptions& options) {
  Publication publication(path);
  {
    Hdf5File file = Hdf5File::create(publication.aside(), path);
    write_header(file, shard.header);
    write_nodes(file, shard.header, shard.nodes, options);
    for (std::size_t lod = 0; lod < shard.levels.size(); ++lod)
      write_level(file, shard.header, shard.levels[lod], int(lod), options);
    file.close();
  }
  const std::uint64_t bytes = std::filesystem::file_size(publication.aside());
  publication.publish();
  return bytes;
}

}  // namespace gigabake
