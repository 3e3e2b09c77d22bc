#include <algorithm>
#include <fcntl.h>
#include <memory>
#include <optional>
#include <utility>

#include "core/base/trace.h"
#include "core/base/work_counts.h"
#include "format/shard/columns/channels.h"
#include "format/shard/columns/shard_columns.h"
#include "format/shard/levels/above.h"
#include "format/shard/packed_shard.h"
#include "format/shard/shard.h"
#include "format/shard/shard_layout.h"
#include "format/shard/splice/spliced_shard.h"
#include "format/shard/temporary_shard.h"
#include "format/system/descriptor.h"
#include "format/system/meters/stage_clock.h"
#include "format/system/publish.h"
#include "format/system/publish_place.h"

namespace gigabake {
namespace {

void write_header(Hdf5File& file, const ShardHeader& h, const DownsampleState& above) {
  const auto u32 = [&](const char* name, std::uint32_t v) { file.write_attribute(name, Hdf5Type::u32, &v, 0); };
  file.write_attribute("format", shard_format);
  const std::int32_t version = h.has_classes     ? first_version_of_classes
                               : h.leaf_lod != 0 ? first_version_of_leaves
                                                 : first_version_of_differences;
  file.write_attribute("version", Hdf5Type::i32, &version, 0);
  file.write_attribute("generator", h.generator);
  file.write_attribute("cell", h.cell);
  file.write_attribute("lattice_min", Hdf5Type::i64, h.lattice_min.v, 3);
  u32("cell_voxels", h.cell_voxels);
  file.write_attribute("voxel_size_m", Hdf5Type::f64, &h.voxel_size_m, 0);
  file.write_attribute("lattice_origin_m", Hdf5Type::f64, h.lattice_origin_m.v, 3);
  u32("brick_edge", brick_edge);
  u32("lods", h.lods);
  u32("first_lod", h.first_lod);
  u32("copied_lods", h.copied_lods);
  if (h.leaf_lod != 0) u32("leaf_lod", h.leaf_lod);
  if (h.origin) {
    const double origin[3] = {h.origin->latitude_deg, h.origin->longitude_deg, h.origin->height_m};
    file.write_attribute("origin", Hdf5Type::f64, origin, 3);
  }
  file.write_attribute("fingerprint", h.fingerprint.hex());
  std::string hashes;
  for (const Hash128& hash : h.content_hash) hashes += (hashes.empty() ? "" : " ") + hash.hex();
  file.write_attribute("content_hash", hashes);
  if (!above.empty()) file.write_attribute("above_hash", hash_of(above).hex());
  file.write_attribute("channels", channel_names({h.has_normals, h.has_directional_coverage, h.has_classes}));
  file.write_attribute("triangles", Hdf5Type::u64, &h.triangles, 0);
}

/// Writes the header and the columns that `add_columns` adds, and closes the file.
template <class AddColumns>
StoredShard make_file(Hdf5File file, const ShardHeader& header, const DownsampleState& above,
                      const ShardWriteOptions& options, const AddColumns& add_columns) {
  const TraceSpan span("HDF5");
  {
    const InStage writing(BakeStage::writing);
    write_header(file, header, above);
  }
  ShardColumns columns(header);
  {
    const InStage packing(BakeStage::packing);
    add_columns(columns);
  }
  const StoredShard stored = columns.stored_bytes(file.write_columns(columns.columns(), options.codec, options.pool));
  const InStage writing(BakeStage::writing);
  file.write_chunk_table(options.codec);
  file.close();
  return stored;
}

template <class Visit>
void for_each_column(const PackedShard& shard, const Visit& visit) {
  for (const PackedColumn& column : shard.nodes) visit(column);
  for (const PackedLevel& level : shard.levels)
    for (const PackedColumn& column : level.columns) visit(column);
}

/// The work that remains to write a packed shard.
struct Ahead {
  std::uint64_t bytes = 0;  ///< approximate size of the file; an upper bound if columns are raw
  bool is_packed = true;    ///< all columns are packed, so only copying remains

  explicit Ahead(const PackedShard& shard) {
    for_each_column(shard, [this](const PackedColumn& column) {
      bytes += column.raw.size();
      for (const std::span<const std::uint8_t> chunk : column.stored) bytes += chunk.size();
      is_packed = is_packed && column.raw.empty();
    });
  }
};

/// Returns the size of a complete file.
std::uint64_t written_bytes(const std::filesystem::path& temporary) {
  const std::uint64_t bytes = std::filesystem::file_size(temporary);
  count_work(WorkCounter::shard_bytes_written, bytes);
  return bytes;
}

void write_image(const FileImage& image, const std::filesystem::path& temporary, const std::filesystem::path& path) {
  const TraceSpan span("write file");
  const InStage writing(BakeStage::writing);
  const Descriptor out(temporary, O_WRONLY | O_TRUNC);
  if (!out.is_open() || !image.write_to(out)) fail_to(path, "write");
}

/// Writes the temporary file of a publication with `write`, and publishes it.
template <class Write>
auto published(const std::filesystem::path& path, const Write& write) {
  Publication publication(path);
  auto stored = write(publication.temporary());
  const InStage writing(BakeStage::writing);
  publication.publish();
  return stored;
}

FileImage& image_of_thread() {
  thread_local FileImage image;  // one per writer thread
  return image;
}

/// Returns an upper bound of the bytes of all arrays of the levels.
std::uint64_t array_bytes(const Shard& shard) {
  constexpr std::uint64_t voxel_bytes = 4 + 2 + directional_coverage_bytes + sizeof(VoxelClass), brick_bytes = 72;
  std::uint64_t bytes = 0;
  for (const BrickLevel& level : shard.levels)
    bytes += voxel_bytes * (level.rgba.size() / 4) + brick_bytes * (level.mask.size() / 8);
  return bytes;
}

/// Max bytes of the arrays of a small shard. One thread packs it in about the time that threads need to join, and its
/// time is mostly that of HDF5's calls: these write to memory, without system calls.
constexpr std::uint64_t small_shard_bytes = std::uint64_t(1) << 20;

}  // namespace

StoredShard write_temporary_shard(const std::filesystem::path& temporary, const std::filesystem::path& path,
                                  const Shard& shard, const ShardWriteOptions& options) {
  const std::uint64_t bytes = array_bytes(shard);
  const bool is_small = bytes <= small_shard_bytes, in_memory = is_small && bytes <= options.image_bytes;
  const ShardWriteOptions making{is_small ? callers_thread() : options.pool, options.codec, options.image_bytes};
  FileImage& image = image_of_thread();
  StoredShard stored = make_file(in_memory ? Hdf5File::create(image, path) : Hdf5File::create(temporary, path),
                                 shard.header, shard.above, making, [&](ShardColumns& columns) {
                                   columns.add_nodes(shard.nodes);
                                   columns.add_above(shard.above);
                                   columns.add_levels(shard.nodes, shard.levels, making.pool);
                                 });
  if (in_memory) write_image(image, temporary, path);
  stored.file = written_bytes(temporary);
  return stored;
}

StoredShard write_shard(const std::filesystem::path& path, const Shard& shard, const ShardWriteOptions& options) {
  return published(path, [&](const std::filesystem::path& temporary) {
    return write_temporary_shard(temporary, path, shard, options);
  });
}

StoredSplice write_spliced_shard(const std::filesystem::path& path, const SplicedShard& shard, const BaseShard& base,
                                 const ShardWriteOptions& options) {
  std::vector<std::unique_ptr<SplicedRows>> levels(shard.levels.size());
  std::vector<std::pair<std::size_t, LevelColumn>> columns_of_all;
  for (std::size_t lod = 0; lod < levels.size(); ++lod)
    for (const LevelColumn column : level_columns(shard.header, int(lod))) columns_of_all.emplace_back(lod, column);
  const auto has_coverage = [&](std::size_t lod) {
    return std::ranges::find(columns_of_all, std::pair(lod, LevelColumn::facing)) != columns_of_all.end();
  };
  options.pool.parallel_for(levels.size(), 1, [&](std::size_t lod, std::size_t, int) {
    const SplicedLevel* above = lod + 1 < levels.size() ? &shard.levels[lod + 1] : nullptr;
    levels[lod] = std::make_unique<SplicedRows>(shard.levels[lod], above, base.level(lod), has_coverage(lod),
                                                options.pool.threads());
  });
  options.pool.parallel_for(columns_of_all.size(), 1, [&](std::size_t c, std::size_t, int) {
    levels[columns_of_all[c].first]->read_chunks(columns_of_all[c].second);
  });
  return published(path, [&](const std::filesystem::path& temporary) {
    StoredSplice out{make_file(Hdf5File::create(temporary, path), shard.header, shard.above, options,
                               [&](ShardColumns& columns) {
                                 columns.add_nodes(shard.nodes);
                                 columns.add_above(shard.above);
                                 for (const auto& level : levels) columns.add_level(*level);
                               }),
                     0};
    for (const auto& level : levels) out.copied += level->copied_bytes();
    out.stored.file = written_bytes(temporary);
    return out;
  });
}

StoredShard write_temporary_shard(const std::filesystem::path& temporary, const std::filesystem::path& path,
                                  const PackedShard& shard, const ShardWriteOptions& options) {
  FileImage& image = image_of_thread();
  const Ahead ahead(shard);
  const bool in_memory = ahead.is_packed || ahead.bytes <= options.image_bytes;
  // A packed shard is made in one turn. A turn must not wait for threads, so this thread packs the few other columns.
  std::optional<Hdf5Turn> turn;
  if (ahead.is_packed) {
    const TraceSpan span("wait for HDF5");
    turn.emplace();
  }
  const ShardWriteOptions making{ahead.is_packed ? callers_thread() : options.pool, options.codec, options.image_bytes};
  StoredShard stored = make_file(in_memory ? Hdf5File::create(image, path) : Hdf5File::create(temporary, path),
                                 shard.header, shard.above, making, [&](ShardColumns& columns) {
                                   columns.add_nodes(shard.nodes);
                                   columns.add_above(shard.above);
                                   for (const PackedLevel& level : shard.levels) columns.add_level(level);
                                 });
  turn.reset();
  if (in_memory) write_image(image, temporary, path);
  stored.file = written_bytes(temporary);
  return stored;
}

StoredShard write_packed_shard(const std::filesystem::path& path, const PackedShard& shard,
                               const ShardWriteOptions& options) {
  return published(path, [&](const std::filesystem::path& temporary) {
    return write_temporary_shard(temporary, path, shard, options);
  });
}

}  // namespace gigabake
