#include "format/source/raster/dem_source.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "core/math/transform.h"
#include "format/area/area_in_scene.h"
#include "format/source/origin_check.h"

namespace gigabake {

namespace {

/// Returns the file to name in messages about a tile: the first raster of the surface that the tile touches.
const std::filesystem::path& file_of(const DemTile& tile) {
  const std::vector<DemPart>& parts = tile.raster->parts;
  const auto at = std::find_if(parts.begin(), parts.end(), [&](const DemPart& part) { return touches(tile, part); });
  return (at == parts.end() ? parts.front() : *at).options.dem;
}

/// Returns the total size of the rasters of a surface.
std::uint64_t bytes_of(const SourceFiles& files, const DemRaster& raster) {
  std::uint64_t bytes = 0;
  for (const DemPart& part : raster.parts) bytes += files.size_of(part.options.dem);
  return bytes;
}

bool is_outside(const AreaInScene& area, const DemTile& tile, const Affine<Scene, World>& scene_from_raster) {
  if (tile.low_m == tile.high_m) return false;
  const auto at = [&](std::size_t c, double part) { return tile.low_m[c] + (tile.high_m[c] - tile.low_m[c]) * part; };
  const BoxSamples box = samples_of([&](double x, double y, double z) {
    return scene_from_raster({at(0, x), at(1, y), at(2, z)});
  });
  return area.overlap(box) == AreaOverlap::outside;
}

SceneSources surface_source(const std::filesystem::path& root, const DemSurface& tiles, const SourceOptions& options,
                            const Progress& progress) {
  SceneSources out;
  out.root = root;
  const DemRaster& raster = *tiles.front().raster;
  const Geodetic middle = raster.origin;
  if (!options.local) out.origin = options.origin ? *options.origin : middle;
  if (out.origin)
    if (auto warning = far_origin_warning(*out.origin, {middle})) out.notes.push_back(std::move(*warning));
  Affine<Scene, World> scene_from_raster;
  if (out.origin && *out.origin != middle)
    scene_from_raster.m = (scene_from_ecef(*out.origin) * ecef_from_enu(middle)).m;
  std::optional<AreaInScene> area;
  if (options.area) area.emplace(options.area, out.origin);
  const std::uint64_t bytes = bytes_of(SourceFiles(root), raster);
  progress.step("laying out the raster's tiles", tiles.size(), "tile");
  std::string name;  // cached, because name_in() needs system calls
  for (const DemTile& t : tiles) {
    progress.advance();
    if (area && is_outside(*area, t, scene_from_raster)) {
      ++out.outside;
      continue;
    }
    TileRef tile;
    const std::filesystem::path& file = file_of(t);
    if (out.tiles.empty() || file != out.tiles.back().path) name = name_in(root, file);
    tile.path = file;
    tile.name = name + "[" + std::to_string(t.column) + "," + std::to_string(t.row) + "]";
    tile.kind = ContentKind::dem;
    tile.scene_from_tile = scene_from_raster * translation<World, World>(t.offset_m[0], t.offset_m[1], t.offset_m[2]);
    tile.bytes = bytes / tiles.size();
    tile.dem = std::make_shared<const DemTile>(t);
    out.tiles.push_back(std::move(tile));
  }
  return out;
}

/// Adds one line per statement about heights, with the name of the first file and the number of other files.
void add_height_notes(const std::vector<DemSurface>& surfaces, const std::filesystem::path& root,
                      std::vector<std::string>& notes) {
  std::vector<std::pair<std::string, std::vector<std::filesystem::path>>> files;
  for (const DemSurface& surface : surfaces)
    for (const DemPart& part : surface.front().raster->parts) {
      if (part.heights_note.empty()) continue;
      const auto known = [&](const auto& entry) { return entry.first == part.heights_note; };
      auto at = std::find_if(files.begin(), files.end(), known);
      if (at == files.end()) at = files.insert(files.end(), {part.heights_note, {}});
      at->second.push_back(part.options.dem);
    }
  for (const auto& [note, names] : files)
    notes.push_back(name_in(root, names.front()) +
                    (names.size() > 1 ? " and " + std::to_string(names.size() - 1) + " more" : "") + ": " + note);
}

bool has_extension(const std::filesystem::path& path, std::initializer_list<std::string_view> extensions) {
  const std::string extension = lower_extension(path);
  return std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}

}  // namespace

bool is_raster_name(const std::filesystem::path& path) {
  return has_extension(path, {".tif", ".tiff", ".asc", ".hgt", ".vrt"});
}

bool is_other_raster_name(const std::filesystem::path& path) {
  return has_extension(path, {".img",  ".dem",  ".bil", ".bip", ".bsq",  ".flt", ".grd", ".nc",   ".jp2", ".dt0",
                              ".dt1",  ".dt2",  ".ecw", ".sid", ".xyz",  ".ter", ".adf", ".gpkg", ".png", ".jpg",
                              ".jpeg", ".webp", ".h5",  ".grb", ".grib", ".bt",  ".rst", ".ers",  ".lbl", ".cub"});
}

std::vector<std::filesystem::path> rasters_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files, mosaics;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (is_raster_name(it->path()) && it->is_regular_file(error) && !it->is_symlink(error))
      (lower_extension(it->path()) == ".vrt" ? mosaics : files).push_back(it->path());
  if (error) throw InputError(folder, "", "cannot be listed: " + error.message());
  if (!mosaics.empty()) files = std::move(mosaics);
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<SceneSources> dem_sources(const std::filesystem::path& root, const std::vector<DemOptions>& rasters,
                                      const SourceOptions& options, const Progress& progress) {
  progress.step(rasters.size() == 1 ? "opening the raster" : "opening the rasters");
  std::vector<SceneSources> out;
  SourceOptions own = options;
  const std::vector<DemSurface> surfaces = open_dem(rasters, options.local);
  for (const DemSurface& surface : surfaces) {
    out.push_back(surface_source(root, surface, own, progress));
    if (options.area && !is_on_earth(*options.area)) own.area = nullptr;  // later surfaces have other frames
  }
  add_height_notes(surfaces, root, out.front().notes);
  return out;
}

/// Returns a member that is a number or a list of numbers; empty if it is absent.
std::vector<double> numbers_of(const JsonMembers& entry, const char* key) {
  const Json* value = entry.value(key);
  if (value == nullptr || !value->is_array()) {
    const auto number = entry.find<double>(key);
    return number ? std::vector<double>{*number} : std::vector<double>{};
  }
  if (value->empty()) entry.fail(key, "expected a number or a list of numbers");
  return *entry.numbers(key, value->size());
}

std::vector<DemOptions> dem_options(const JsonMembers& entry) {
  const std::filesystem::path& scene_file = entry.file();
  const std::filesystem::path root = scene_file.parent_path().empty() ? "." : scene_file.parent_path();
  std::error_code error;
  const auto file = [&](const char* key) {
    const auto name = entry.find<std::string>(key);
    if (!name) return std::filesystem::path();
    const std::filesystem::path path = resolve_name(root, scene_file, entry.path_of(key), *name);
    if (!SourceFiles(root).has(path) && !std::filesystem::is_directory(path, error))
      entry.fail(key, "no such file: " + in_quotes(*name));
    return path;
  };
  DemOptions out;
  out.dem = file("dem");
  out.ortho = file("ortho");
  out.crs = entry.find<std::string>("crs").value_or("");
  out.ortho_crs = entry.find<std::string>("ortho_crs").value_or("");
  out.nodata = numbers_of(entry, "nodata");
  out.height_scale = entry.find<double>("height_scale");
  out.geoid_offset_m = entry.find<double>("geoid_offset_m");
  const std::uint64_t cells = entry.find<std::uint64_t>("tile_cells").value_or(256);
  if (cells < 16 || cells > 4096) entry.fail("tile_cells", "expected 16 to 4096");
  out.tile_cells = int(cells);
  if (!std::filesystem::is_directory(out.dem, error)) return {out};
  std::vector<DemOptions> parts;
  for (const std::filesystem::path& part : rasters_in(out.dem)) parts.push_back(out), parts.back().dem = part;
  if (parts.empty()) entry.fail("dem", "the folder holds no .tif, .tiff, .asc, .hgt or .vrt");
  return parts;
}

TileMesh read_dem_tile(const TileRef& tile, ReadScope scope) {
  DemMesh dem = read_dem(*tile.dem, scope != ReadScope::positions_only);
  TileMesh out;
  out.counts.triangles = dem.primitive.index.size() / 3;
  Affine<Scene, Local> scene_from_local;
  scene_from_local.m = tile.scene_from_tile.m;
  out.instances.push_back({0, scene_from_local});
  out.primitives.push_back(std::move(dem.primitive));
  out.materials.push_back(dem.material);
  out.images = std::move(dem.images);
  out.warnings.assign(dem.warnings.begin(), dem.warnings.end());
  return out;
}

}  // namespace gigabake
