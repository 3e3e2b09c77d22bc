#include "format/source/raster/dem_source.h"

#include "format/source/origin_check.h"
#include "lattice/error.h"
#include "lattice/georeference.h"
#include "lattice/transform.h"

namespace gigabake {

SceneSources dem_sources(const std::filesystem::path& root, const DemOptions& dem, const SourceOptions& options,
                         const Progress& progress) {
  progress.step("opening the raster");
  SceneSources out;
  out.root = root;
  const std::vector<DemTile> tiles = open_dem(dem);
  const Geodetic middle = tiles.front().raster->origin;
  if (!options.local) out.origin = options.origin ? *options.origin : middle;
  if (out.origin)
    if (auto warning = far_origin_warning(*out.origin, {middle})) out.notes.push_back(std::move(*warning));
  Affine<Scene, World> scene_from_raster;
  if (out.origin && *out.origin != middle)
    scene_from_raster.m = (scene_from_ecef(*out.origin) * ecef_from_enu(middle)).m;
  const std::string name = name_in(root, dem.dem);
  const std::uint64_t bytes = SourceFiles(root).size_of(dem.dem);
  progress.step("laying out the raster's tiles", tiles.size(), "tile");
  for (const DemTile& t : tiles) {
    progress.advance();
    TileRef tile;
    tile.path = dem.dem;
    tile.name = name + "[" + std::to_string(t.column) + "," + std::to_string(t.row) + "]";
    tile.kind = ContentKind::dem;
    tile.scene_from_tile = scene_from_raster * translation<World, World>(t.offset_m[0], t.offset_m[1], t.offset_m[2]);
    tile.bytes = bytes / tiles.size();
    tile.dem = std::make_shared<const DemTile>(t);
    out.tiles.push_back(std::move(tile));
  }
  return out;
}

DemOptions dem_options(const std::filesystem::path& scene_file, const Json& entry, const std::string& where) {
  const std::filesystem::path root = scene_file.parent_path().empty() ? "." : scene_file.parent_path();
  const auto file = [&](const char* key) {
    const auto name = get_text(scene_file, entry, where, key);
    if (!name) return std::filesystem::path();
    const std::filesystem::path path = resolve_path(root, scene_file, where + "." + key, *name);
    if (!SourceFiles(root).has(path))
      throw InputError(scene_file, where + "." + key, "no such file: " + in_quotes(*name));
    return path;
  };
  DemOptions out;
  out.dem = file("dem");
  out.ortho = file("ortho");
  out.crs = get_text(scene_file, entry, where, "crs").value_or("");
  out.nodata = get_number(scene_file, entry, where, "nodata");
  out.height_scale = get_number(scene_file, entry, where, "height_scale");
  out.geoid_offset_m = get_number(scene_file, entry, where, "geoid_offset_m");
  const std::uint64_t cells = get_index(scene_file, entry, where, "tile_cells").value_or(256);
  if (cells < 16 || cells > 4096) throw InputError(scene_file, where + ".tile_cells", "expected 16 to 4096");
  out.tile_cells = int(cells);
  return out;
}

TileMesh read_dem_tile(const TileRef& tile, ReadScope scope) {
  DemMesh dem = read_dem(*tile.dem, scope == ReadScope::everything);
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
