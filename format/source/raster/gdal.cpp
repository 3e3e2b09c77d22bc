#include <algorithm>
#include <cmath>
#include <gdal_frmts.h>
#include <limits>
#include <mutex>
#include <sstream>
#include <string_view>

#include "format/source/raster/crs_text.h"
#include "format/source/raster/dem.h"
#include "format/source/raster/dem_checks.h"
#include "format/source/raster/gdal_module.h"
#include "format/source/raster/gdal_raster.h"
#include "format/source/raster/height_values.h"
#include "format/source/raster/proj_files.h"
#include "lattice/error.h"
#include "lattice/georeference.h"
#include "lattice/memory_limit.h"

namespace gigabake {
namespace {

void register_drivers() {
  static std::once_flag once;
  std::call_once(once, [] {
    CPLSetConfigOption("GDAL_CACHEMAX", "64");
    CPLSetConfigOption("GDAL_PAM_ENABLED", "NO");  // writes nothing beside sources
    confine_proj();
    // No others: what stands beside a raster (masks, overviews) is opened by whichever driver knows it, and some fetch
    // what they are told from the network.
    GDALRegister_GTiff(), GDALRegister_AAIGrid(), GDALRegister_SRTMHGT(), GDALRegister_PNG(), GDALRegister_JPEG();
    GDALRegister_MEM();
  });
}

}  // namespace

Dataset open_raster(const std::filesystem::path& file, const char* key) {
  register_drivers();
  static const char* const drivers[] = {"GTiff", "AAIGrid", "SRTMHGT", "PNG", "JPEG", nullptr};
  Dataset out(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers));
  if (!out || out->GetRasterCount() < 1)
    throw InputError(file, key, "expected a GeoTIFF, ASCII grid, HGT, PNG or JPEG raster" + QuietErrors::last());
  return out;
}

const OGRSpatialReference* plain_crs_of(GDALDataset& dataset) {
  const OGRSpatialReference* crs = dataset.GetSpatialRef();
  return crs != nullptr && is_plain_crs(wkt_of(*crs)) ? crs : nullptr;
}

std::string wkt_of(const OGRSpatialReference& crs) {
  char* text = nullptr;
  crs.exportToWkt(&text);
  std::string out = text != nullptr ? text : "";
  CPLFree(text);
  return out;
}

OGRSpatialReference whole_crs_of(const DemOptions& options, GDALDataset& dataset) {
  OGRSpatialReference crs;
  if (!options.crs.empty()) {
    // GDAL would also fetch an address and open a file.
    if (!is_plain_crs(options.crs) ||
        crs.SetFromUserInput(options.crs.c_str(), OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get()) !=
            OGRERR_NONE)
      throw InputError(options.dem, "crs",
                       "is unknown: " + in_quotes(options.crs) + "; expected EPSG:…, WKT or a PROJ text");
  } else if (const OGRSpatialReference* own = plain_crs_of(dataset)) {
    crs = *own;
  } else {
    throw InputError(options.dem, "crs",
                     "the raster has no coordinate system, or one that leads to files; set it in the scene file, as "
                     "\"crs\": \"EPSG:25832\"");
  }
  return crs;
}

OGRSpatialReference crs_of(const DemOptions& options, GDALDataset& dataset) {
  OGRSpatialReference crs = whole_crs_of(options, dataset);
  crs.StripVertical();
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

namespace {

using Path = std::filesystem::path;

constexpr double quantum_m = 1.0 / 1024;
/// A pixel smaller or larger than this on the ground: degrees taken for metres, or the other way round.
constexpr double least_pixel_m = 1e-3, largest_pixel_m = 2e5;
constexpr std::uint64_t most_tiles = std::uint64_t(1) << 22;

Grid grid_of(const Path& file, GDALDataset& dataset) {
  Grid grid;
  if (dataset.GetGeoTransform(grid.g) != CE_None || !std::isnormal(grid.determinant()))
    throw InputError(file, "dem",
                     "the raster does not say where its pixels lie; give it a geotransform or a world file");
  return grid;
}

Geodetic geodetic(double lon, double lat, double height_m) {
  return {std::clamp(lat, -90.0, 90.0), std::remainder(lon, 360.0), height_m};
}

/// Six digits, however large it is.
std::string short_number(double v) {
  std::ostringstream text;
  text << v;
  return text.str();
}

/// Metres between two neighbouring pixels at the raster's middle say whether the numbers fit the coordinate system.
Geodetic checked_origin(const DemRaster& raster, const Grid& grid, const EarthMap& earth) {
  const double c = (raster.columns - 1) / 2.0, r = (raster.rows - 1) / 2.0, e = raster.columns - 1, s = raster.rows - 1;
  const double at[7][2] = {{c, r}, {c + 1, r}, {c, r + 1}, {0, 0}, {e, 0}, {0, s}, {e, s}};
  std::vector<double> x, y;
  for (const auto& p : at) {
    const auto [px, py] = grid.place(p[0], p[1]);
    x.push_back(px), y.push_back(py);
  }
  earth.to_lon_lat(x, y);
  const auto ecef = [&](std::size_t i) { return ecef_of(geodetic(x[i], y[i], 0)); };
  for (const std::size_t i : {1, 2}) {
    const Point<Ecef> a = ecef(0), b = ecef(i);
    const double pixel_m = std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
    if (!(pixel_m >= least_pixel_m && pixel_m <= largest_pixel_m))
      throw InputError(raster.options.dem, "crs",
                       "a pixel would be " + short_number(pixel_m) + " m wide in the raster's coordinate system (" +
                           earth.name() + "); set the right one in the scene file");
  }
  return geodetic(x[0], y[0], 0);
}

/// Reads a tile's window of pixels, as doubles.
std::vector<double> read_window(const DemTile& tile, GDALRasterBand& band) {
  const int width = tile.columns + 1, height = tile.rows + 1;
  std::vector<double> values(std::size_t(width) * std::size_t(height));
  if (band.RasterIO(GF_Read, tile.column, tile.row, width, height, values.data(), width, height, GDT_Float64, 0, 0) !=
      CE_None)
    throw InputError(tile.raster->options.dem, "dem", "cannot be read" + QuietErrors::last());
  return values;
}

HeightRule height_rule(const DemOptions& o, GDALRasterBand& band) {
  HeightRule rule;
  int has_nodata = 0;
  const double own = band.GetNoDataValue(&has_nodata);
  if (has_nodata != 0) rule.nodata = own;
  if (o.nodata) rule.nodata = *o.nodata;
  rule.scale = band.GetScale(), rule.offset = band.GetOffset(), rule.unit_m = height_scale_of(o, band);
  rule.geoid_offset_m = o.geoid_offset_m.value_or(0);
  rule.is_nodata_chosen = o.nodata.has_value(), rule.is_unit_chosen = o.height_scale.has_value();
  return rule;
}

/// Heights above the ellipsoid of a window of pixels; NaN where there is no value.
std::vector<double> heights(const DemTile& tile, GDALDataset& dataset, std::vector<std::string>& warnings) {
  const DemOptions& o = tile.raster->options;
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  std::vector<double> z = read_window(tile, band);
  if (GDALRasterBand* validity = validity_band(dataset)) {
    const std::vector<double> is_valid = read_window(tile, *validity);
    for (std::size_t i = 0; i < z.size(); ++i)
      if (is_valid[i] == 0) z[i] = std::numeric_limits<double>::quiet_NaN();
  }
  warnings = take_heights(o.dem, height_rule(o, band), z);
  return z;
}

/// Places of a rectangle of pixels in the raster's frame, row by row.
std::vector<Point<Scene>> places(const DemTile& tile, const Grid& grid, const EarthMap& earth,
                                 const std::vector<double>& height_m) {
  const Affine<Scene, Ecef> frame = scene_from_ecef(tile.raster->origin);
  std::vector<Point<Scene>> out;
  const int width = tile.columns + 1;
  for (int r = 0; r <= tile.rows; ++r) {
    std::vector<double> x, y;
    for (int c = 0; c < width; ++c) {
      const auto [px, py] = grid.place(tile.column + c, tile.row + r);
      x.push_back(px), y.push_back(py);
    }
    earth.to_lon_lat(x, y);
    for (int c = 0; c < width; ++c) {
      const double h = height_m[std::size_t(r * width + c)];
      out.push_back(frame(ecef_of(geodetic(x[std::size_t(c)], y[std::size_t(c)], h))));
    }
  }
  return out;
}

void add_triangles(const DemTile& tile, const std::vector<double>& height_m, bool is_mirrored, Primitive& out) {
  const auto width = std::uint32_t(tile.columns + 1);
  for (std::uint32_t r = 0; r < std::uint32_t(tile.rows); ++r)
    for (std::uint32_t c = 0; c < std::uint32_t(tile.columns); ++c) {
      const std::uint32_t a = r * width + c, b = a + 1, d = a + width, e = d + 1;
      if (std::isnan(height_m[a] + height_m[b] + height_m[d] + height_m[e])) continue;
      if (is_mirrored)  // rows go south: the usual way
        out.index.insert(out.index.end(), {a, e, b, a, d, e});
      else
        out.index.insert(out.index.end(), {a, b, e, a, e, d});
    }
}

/// Places of the tiles' middles, in whole metres of the raster's frame.
void place_tiles(const Grid& grid, const EarthMap& earth, std::vector<DemTile>& tiles) {
  std::vector<double> x, y;
  for (const DemTile& t : tiles) {
    const auto [px, py] = grid.place(t.column + t.columns / 2.0, t.row + t.rows / 2.0);
    x.push_back(px), y.push_back(py);
  }
  earth.to_lon_lat(x, y);
  const Affine<Scene, Ecef> frame = scene_from_ecef(tiles.front().raster->origin);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const Point<Scene> p = frame(ecef_of(geodetic(x[i], y[i], 0)));
    tiles[i].offset_m = {std::round(p.x), std::round(p.y), std::round(p.z)};
  }
}

void add_files(const Path& file, const char* key, std::vector<Path>& out) {
  const Dataset dataset = open_raster(file, key);
  char** names = dataset->GetFileList();
  for (char** name = names; name != nullptr && *name != nullptr; ++name) out.emplace_back(*name);
  CSLDestroy(names);
  if (std::find(out.begin(), out.end(), file) == out.end()) out.push_back(file);
}

/// An ASCII grid says how many numbers follow, and each takes a character and a space.
void expect_whole_text(const DemRaster& raster, GDALDataset& dataset) {
  if (std::string_view(dataset.GetDriver()->GetDescription()) != "AAIGrid") return;
  const std::uint64_t pixels = std::uint64_t(raster.columns) * std::uint64_t(raster.rows);
  const std::uint64_t bytes = std::filesystem::file_size(raster.options.dem);
  if (pixels > bytes)
    throw InputError(raster.options.dem, "dem",
                     "the grid says it has " + std::to_string(raster.columns) + " × " + std::to_string(raster.rows) +
                         " values, more than its " + std::to_string(bytes) + " bytes can hold");
}

/// Of one tile as it is read: heights, places, vertices and triangles of each pixel, and GDAL's own blocks.
void claim_tile(const DemRaster& raster, GDALDataset& dataset) {
  constexpr std::uint64_t pixel_bytes = 96, block_value_bytes = 16;
  int width = 0, height = 0;
  dataset.GetRasterBand(1)->GetBlockSize(&width, &height);
  MemoryClaim claim(raster.options.dem, "store it in smaller blocks");
  claim.add_items(std::uint64_t(width) * std::uint64_t(height), block_value_bytes, "dem", "pixels of a block");
  const auto edge = [&](int pixels) { return std::uint64_t(std::min(pixels, raster.options.tile_cells + 1)); };
  MemoryClaim(raster.options.dem, "lower tile_cells in the scene file")
      .add_items(edge(raster.columns) * edge(raster.rows), pixel_bytes, "tile_cells", "points of a tile");
}

/// A tile here and as the source of a scene, with its name.
constexpr std::uint64_t tile_bytes = 800;

std::vector<DemTile> tiles_of(const DemOptions& options) {
  const QuietErrors quiet;
  const Dataset dataset = open_raster(options.dem, "dem");
  const Grid grid = grid_of(options.dem, *dataset);
  auto raster = std::make_shared<DemRaster>();
  raster->options = options;
  raster->columns = dataset->GetRasterXSize();
  raster->rows = dataset->GetRasterYSize();
  if (raster->columns < 2 || raster->rows < 2)
    throw InputError(options.dem, "dem", "expected at least 2 × 2 pixels, which are the terrain's vertices");
  expect_whole_text(*raster, *dataset);
  const EarthMap earth(options, *dataset);
  raster->origin = checked_origin(*raster, grid, earth);
  raster->warnings = check_dem(options, *dataset);
  if (!options.ortho.empty()) open_raster(options.ortho, "ortho");
  const int edge = options.tile_cells;
  claim_tile(*raster, *dataset);
  if (std::uint64_t(raster->columns / edge + 1) * std::uint64_t(raster->rows / edge + 1) > most_tiles)
    throw InputError(options.dem, "tile_cells", "more than 2^22 tiles; enlarge it in the scene file");
  MemoryClaim(options.dem, "enlarge tile_cells in the scene file")
      .add_items(std::uint64_t(raster->columns / edge + 1) * std::uint64_t(raster->rows / edge + 1), tile_bytes,
                 "tile_cells", "tiles");
  std::vector<DemTile> tiles;
  for (int row = 0; row < raster->rows - 1; row += edge)
    for (int column = 0; column < raster->columns - 1; column += edge)
      tiles.push_back({raster,
                       column,
                       row,
                       std::min(edge, raster->columns - 1 - column),
                       std::min(edge, raster->rows - 1 - row),
                       {}});
  place_tiles(grid, earth, tiles);
  return tiles;
}

DemMesh mesh_of(const DemTile& tile, bool with_ortho) {
  const QuietErrors quiet;
  const DemOptions& o = tile.raster->options;
  const Dataset dataset = open_raster(o.dem, "dem");
  if (dataset->GetRasterXSize() != tile.raster->columns || dataset->GetRasterYSize() != tile.raster->rows)
    throw InputError(o.dem, "dem", "changed while the bake ran; bake again");
  const Grid grid = grid_of(o.dem, *dataset);
  const EarthMap earth(o, *dataset);
  DemMesh out;
  const std::vector<double> height_m = heights(tile, *dataset, out.warnings);
  for (const Point<Scene>& p : places(tile, grid, earth, height_m)) {
    const double xyz[3] = {p.x, p.y, p.z};
    for (std::size_t c = 0; c < 3; ++c)
      out.primitive.position.push_back(float(std::floor(xyz[c] / quantum_m + 0.5) * quantum_m - tile.offset_m[c]));
  }
  add_triangles(tile, height_m, grid.determinant() < 0, out.primitive);
  out.material.double_sided = out.material.unlit = true;
  if (!with_ortho || o.ortho.empty() || out.primitive.index.empty()) return out;
  out.images.push_back(read_ortho(tile, grid, earth));
  out.material.texture = {0, Wrap::clamp_to_edge, Wrap::clamp_to_edge, false};
  for (int r = 0; r <= tile.rows; ++r)
    for (int c = 0; c <= tile.columns; ++c) {
      out.primitive.uv.push_back(float(double(c + margin_cells) / (tile.columns + 2 * margin_cells)));
      out.primitive.uv.push_back(float(double(r + margin_cells) / (tile.rows + 2 * margin_cells)));
    }
  return out;
}

std::vector<Path> files_of(const DemOptions& options) {
  const QuietErrors quiet;
  std::vector<Path> out;
  add_files(options.dem, "dem", out);
  if (!options.ortho.empty()) add_files(options.ortho, "ortho", out);
  return out;
}

}  // namespace
}  // namespace gigabake

const gigabake::GdalModule* gigabake_gdal() {
  static const gigabake::GdalModule module{gigabake::set_memory_limit, gigabake::tiles_of, gigabake::mesh_of,
                                           gigabake::files_of};
  return &module;
}
