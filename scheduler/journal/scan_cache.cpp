#include "scheduler/journal/scan_cache.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "core/base/thread_pool.h"
#include "core/io/bytes.h"
#include "format/job/cell_job.h"
#include "format/source/classes/source_classes.h"
#include "format/source/levels/named_voxel_sizes.h"
#include "format/source/raster/dem.h"
#include "format/source/tile_hash.h"
#include "format/system/hash_bytes.h"
#include "format/system/publish.h"
#include "format/system/read_file.h"

namespace gigabake {
namespace {

constexpr std::array<char, 16> magic = {'g', 'i', 'g', 'a', 'b', 'a', 'k', 'e', ' ', 's', 'u', 'r', 'v', 'e', 'y', 's'};
constexpr std::uint64_t max_file_bytes = std::uint64_t(1) << 40;

/// Generation 1 is rejected: its results may come from other parameters than the key contains.
constexpr std::uint64_t cache_generation = 2;
constexpr std::uint64_t file_version = cache_generation << 32 | scan_version;

struct FileHeader {
  std::array<char, 16> magic;
  std::uint64_t version, bytes;
  Hash128 hash;  ///< XXH3 of the content after the header
};
static_assert(sizeof(FileHeader) == 48);

void put_part(const DemPart& part, ByteWriter& w) {
  const DemOptions& o = part.options;
  w.put(o.dem.string()), w.put(o.ortho.string());
  w.put(o.crs), w.put(o.ortho_crs), w.put(o.nodata);
  for (const auto& number : {o.height_scale, o.geoid_offset_m}) {
    w.put(std::uint8_t(number.has_value()));
    w.put(number.value_or(0));
  }
  w.put(o.tile_cells);
  for (const int number : {part.column, part.row, part.columns, part.rows}) w.put(number);
  for (const std::filesystem::path& grid : part.grids) w.put(grid.string());
}

/// Serializes the raster's parts that overlap the tile, the raster's grid, and the tile's position in the grid. Other
/// parts affect the result only through the grid.
void put_dem(const DemTile& tile, ByteWriter& w) {
  const DemRaster& raster = *tile.raster;
  for (const DemPart& part : raster.parts)
    if (touches(tile, part)) put_part(part, w);
  w.put(raster.geotransform), w.put(raster.origin), w.put(raster.texels_per_cell);
  for (const int number : {tile.column, tile.row, tile.columns, tile.rows}) w.put(number);
}

/// Returns a hash of everything that a scan result depends on, except the content of files.
Hash128 key_of(const TileRef& tile, const BakeParameters& p) {
  ByteWriter w;
  w.put(scan_version);
  w.put(tile.name);
  w.put(tile.kind);
  w.put(tile.gltf_up);
  w.put(tile.scene_from_tile.m);
  w.put(tile.world_from_tile.m);
  w.put(tile.range);
  if (tile.dem) put_dem(*tile.dem, w);
  w.put(p.voxel_size_m);
  w.put(p.lattice_origin_m);
  w.put(p.cell_voxels);
  w.put(p.surface);
  if (tile.lod != 0) w.put(tile.lod);
  if (tile.named_sizes) w.put(to_json(*tile.named_sizes));
  if (tile.classes) w.put(to_json(*tile.classes));
  return hash_of_bytes(w.take());
}

bool is_worth_keeping(const TileScan& scan) {
  return scan.error.empty() && !scan.files.empty() &&
         std::all_of(scan.files.begin(), scan.files.end(), [](const StampedFile& f) { return f.settled; });
}

bool is_unchanged(const TileRef& tile, const TileScan& scan) {
  return scan.error.empty() && are_unchanged(tile, scan.files);
}

}  // namespace

ScanCache::ScanCache(const std::filesystem::path& path) {
  try {
    load(path);
  } catch (const std::exception&) {
    scans_.clear();  // an unreadable cache only means that all tiles are scanned again
  }
}

void ScanCache::load(const std::filesystem::path& path) {
  bytes_ = read_whole_file(path, max_file_bytes);
  FileHeader h{};
  if (bytes_.size() < sizeof h) return;
  std::memcpy(&h, bytes_.data(), sizeof h);
  const std::span content = std::span<const std::uint8_t>(bytes_).subspan(sizeof h);
  if (h.magic != magic || h.version != file_version || h.bytes != content.size() || h.hash != hash_of_bytes(content))
    return;
  for (std::size_t at = 0; at < content.size();) {
    ByteReader r(content.subspan(at), "survey cache");
    Hash128 key;
    std::uint64_t bytes = 0;
    r.get(key);
    r.get(bytes);
    at += sizeof key + sizeof bytes;
    if (bytes > content.size() - at) throw InputError(path, "", "a scan extends beyond the end", at);
    scans_[key] = content.subspan(at, bytes);
    at += bytes;
  }
}

std::optional<TileScan> ScanCache::find(const SceneSources& sources, std::uint32_t tile,
                                        const BakeParameters& parameters) const {
  const TileRef& ref = sources.tiles.at(tile);
  const auto it = scans_.find(key_of(ref, parameters));
  if (it == scans_.end()) return std::nullopt;
  try {
    TileScan scan = scan_from_bytes(it->second);
    if (!is_unchanged(ref, scan)) return std::nullopt;
    scan.tile = tile;
    return scan;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::vector<std::optional<TileScan>> ScanCache::find_all(const SceneSources& sources, const BakeParameters& parameters,
                                                         int threads, const Progress& progress) const {
  std::vector<std::optional<TileScan>> found(sources.tiles.size());
  ThreadPool(threads).parallel_for(found.size(), 64, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) found[i] = find(sources, std::uint32_t(i), parameters);
    progress.advance(end - begin);
  });
  return found;
}

void save_scan_cache(const std::filesystem::path& path, const SceneSources& sources, const BakeParameters& parameters,
                     std::span<const TileScan> scans) {
  std::string content;
  const auto put = [&content](const std::vector<std::uint8_t>& bytes) {
    content.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  for (const TileScan& scan : scans) {
    if (!is_worth_keeping(scan)) continue;
    ByteWriter w;
    w.put(key_of(sources.tiles.at(scan.tile), parameters));
    w.put(to_bytes(scan));
    put(w.take());
  }
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
  const FileHeader header{magic, file_version, content.size(), hash_of_bytes(bytes)};
  publish_file(path, std::string(reinterpret_cast<const char*>(&header), sizeof header) + content);
}

}  // namespace gigabake
