#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string_view>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "format/source/raster/crs_text.h"
#include "format/source/raster/dem.h"
#include "format/source/raster/dem_checks.h"
#include "format/source/raster/gdal/gdal_crs.h"
#include "format/source/raster/gdal/gdal_head.h"
#include "format/source/raster/gdal/gdal_heights.h"
#include "format/source/raster/gdal/gdal_open.h"
#include "format/source/raster/gdal/gdal_ortho.h"
#include "format/source/raster/gdal/tile_box.h"
#include "format/source/raster/gdal_module.h"
#include "format/source/raster/ground.h"
#include "format/source/raster/raster_claims.h"
#include "format/source/raster/surface_parts.h"

namespace gigabake {

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

OGRSpatialReference crs_of_text(const std::filesystem::path& file, const char* key, const std::string& text) {
  OGRSpatialReference crs;
  // The check is needed because GDAL may interpret a text as a URL or a file.
  if (!is_plain_crs(text) ||
      crs.SetFromUserInput(text.c_str(), OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get()) != OGRERR_NONE)
    throw InputError(file, key, "is unknown: " + in_quotes(text) + "; expected EPSG:CODE, WKT or a PROJ text");
  return crs;
}

std::optional<OGRSpatialReference> whole_crs_of(const DemOptions& options, GDALDataset& dataset) {
  if (!options.crs.empty()) return crs_of_text(options.dem, "crs", options.crs);
  const OGRSpatialReference* own = plain_crs_of(dataset);
  return own != nullptr ? std::optional(*own) : std::nullopt;
}

std::optional<OGRSpatialReference> crs_of(const DemOptions& options, GDALDataset& dataset) {
  std::optional<OGRSpatialReference> crs = whole_crs_of(options, dataset);
  if (!crs) return crs;
  crs->StripVertical();
  crs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

namespace {

using Path = std::filesystem::path;

constexpr double quantum_m = 1.0 / 1024;
/// The smallest plausible pixel of an orthophoto on the ground. Smaller ones would enlarge the images of all tiles to
/// their max size, whatever the size of the file.
constexpr double min_ortho_pixel_m = 1e-4;

/// Returns the positions of a tile's vertices in the frame of the raster, row by row. Vertices without a value are at
/// the origin of the tile. Vertices that cannot be located on the earth, such as the corners of a global raster, become
/// holes.
std::vector<Point<Scene>> places(const DemTile& tile, const Ground& ground, std::vector<double>& height_m,
                                 std::vector<std::string>& warnings) {
  bool is_off_earth = false;
  const Grid grid{tile.raster->geotransform};
  const Ground::Frame frame(ground, tile.raster->origin);
  std::vector<Point<Scene>> out;
  const int width = tile.columns + 1;
  for (int r = 0; r <= tile.rows; ++r) {
    std::vector<double> x, y;
    for (int c = 0; c < width; ++c) {
      const auto [px, py] = grid.place(tile.column + c, tile.row + r);
      x.push_back(px), y.push_back(py);
    }
    const std::vector<char> is_located = ground.locate(x, y);
    for (std::size_t c = 0; c < std::size_t(width); ++c) {
      double& h = height_m[std::size_t(r) * std::size_t(width) + c];
      is_off_earth |= is_located[c] == 0 && !std::isnan(h);
      if (is_located[c] == 0) h = std::numeric_limits<double>::quiet_NaN();
      if (std::isnan(h)) {
        out.push_back({tile.offset_m[0], tile.offset_m[1], tile.offset_m[2]});
        continue;
      }
      out.push_back(frame(x[c], y[c], h));
    }
  }
  if (is_off_earth)
    warnings.push_back("has heights at places that are not on the earth in its coordinate system (" + ground.name() +
                       "), taken as holes");
  return out;
}

void add_triangles(const DemTile& tile, const std::vector<double>& height_m, bool is_mirrored, Primitive& out) {
  const auto width = std::uint32_t(tile.columns + 1);
  for (std::uint32_t r = 0; r < std::uint32_t(tile.rows); ++r)
    for (std::uint32_t c = 0; c < std::uint32_t(tile.columns); ++c) {
      const std::uint32_t a = r * width + c, b = a + 1, d = a + width, e = d + 1;
      if (std::isnan(height_m[a] + height_m[b] + height_m[d] + height_m[e])) continue;
      if (is_mirrored)  // the usual case: rows run from north to south
        out.index.insert(out.index.end(), {a, e, b, a, d, e});
      else
        out.index.insert(out.index.end(), {a, b, e, a, e, d});
    }
}

/// Sets the origin of each tile to its centre, in whole metres of the frame of the raster, and its box.
void place_tiles(const Ground& ground, std::vector<DemTile>& tiles) {
  const DemRaster& raster = *tiles.front().raster;
  const Grid grid{raster.geotransform};
  const Ground::Frame frame(ground, raster.origin);
  for (DemTile& t : tiles) {
    std::vector<double> x, y;
    for (const auto& [c, r] : sample_points(t.column, t.row, t.columns, t.rows)) {
      const auto [px, py] = grid.place(c, r);
      x.push_back(px), y.push_back(py);
    }
    const std::vector<char> is_located = ground.locate(x, y);
    const auto at = std::find(is_located.begin(), is_located.end(), 1) - is_located.begin();
    if (at == std::ptrdiff_t(is_located.size())) continue;  // places() turns all heights into holes
    const Point<Scene> p = frame(x[std::size_t(at)], y[std::size_t(at)], 0);
    t.offset_m = {std::round(p.x), std::round(p.y), std::round(p.z)};
    if (std::count(is_located.begin(), is_located.end(), 0) == 0) set_box(frame, x, y, t);
  }
}

void add_files(const Path& file, const char* key, std::vector<Path>& out) {
  if (std::find(out.begin(), out.end(), file) != out.end()) return;
  const BorrowedRaster dataset = borrow_raster(file, key);
  out.push_back(file);
  char** names = dataset->GetFileList();
  for (char** name = names; name != nullptr && *name != nullptr; ++name)
    if (Path(*name) != file) out.emplace_back(*name);
  CSLDestroy(names);
  for (const std::string& name : safe_side_files(file))
    if (std::find(out.begin(), out.end(), file.parent_path() / name) == out.end())
      out.push_back(file.parent_path() / name);
}

/// Throws InputError if the pixels of a part's orthophoto are implausibly small on the ground.
void expect_plausible_ortho(const DemPart& part, double pixel_m, const OrthoFacts& facts) {
  const double ortho_pixel_m = pixel_m / facts.texels_per_cell;
  if (ortho_pixel_m >= min_ortho_pixel_m) return;
  throw InputError(part.options.ortho, "ortho_crs",
                   "a pixel of the orthophoto would be " + short_number(ortho_pixel_m) + " m wide, less than " +
                       short_number(min_ortho_pixel_m) +
                       " m; set its right coordinate system in the scene file, or correct its geotransform");
}

/// Sets the resolution of images to the max resolution of the orthophotos. Limits the edge of tiles, so that their
/// images do not exceed the max size.
void set_texels(const std::vector<RasterHead>& heads, const SurfaceHead& surface, DemRaster& raster) {
  double texels = 1;
  for (DemPart& part : raster.parts) {
    if (part.options.ortho.empty()) continue;
    const OGRSpatialReference* crs = heads[surface.heads[0]].crs ? &*heads[surface.heads[0]].crs : nullptr;
    OrthoFacts facts = check_ortho(part, surface.grid, crs);
    expect_plausible_ortho(part, heads[surface.heads[0]].pixel_m, facts);
    texels = std::max(texels, facts.texels_per_cell);
    if (facts.texels_per_cell > max_texels_per_cell)
      facts.warnings.push_back("the orthophoto has " + short_number(std::round(facts.texels_per_cell)) +
                               " pixels per pixel of the raster, of which " + std::to_string(max_texels_per_cell) +
                               " are kept; resample the raster to smaller pixels with gdalwarp -tr");
    part.warnings.insert(part.warnings.end(), facts.warnings.begin(), facts.warnings.end());
  }
  constexpr double tolerance = 0.02;  // allows for the scale factor of a projection
  raster.texels_per_cell = int(std::ceil(std::min(texels, double(max_texels_per_cell)) - tolerance));
  const int cells = (max_texture_edge - 2 * margin_texels(raster.texels_per_cell)) / raster.texels_per_cell;
  for (DemPart& part : raster.parts) part.options.tile_cells = std::max(1, std::min(part.options.tile_cells, cells));
}

DemSurface surface_of(const std::vector<RasterHead>& heads, const SurfaceHead& surface) {
  auto raster = std::make_shared<DemRaster>();
  for (const std::size_t i : surface.heads) raster->parts.push_back(heads[i].part);
  raster->columns = surface.columns, raster->rows = surface.rows;
  raster->geotransform = surface.grid.g;
  set_texels(heads, surface, *raster);
  int edge = raster->parts[0].options.tile_cells;
  for (const DemPart& part : raster->parts) edge = std::min(edge, part.options.tile_cells);
  claim_tiles(*raster, edge);
  claim_image(*raster, edge);
  const std::vector<char> filled = filled_tiles(*raster, edge);
  const BorrowedRaster dataset = borrow_raster(raster->parts[0].options.dem, "dem");
  const Ground ground(raster->parts[0].options, *dataset);
  raster->origin = checked_pixel(raster->parts[0], surface.grid, ground).origin;
  raster->is_on_earth = ground.is_on_earth();
  DemSurface tiles;
  const int columns = (raster->columns - 2) / edge + 1;
  for (std::size_t i = 0; i < filled.size(); ++i) {
    if (filled[i] == 0 && !(tiles.empty() && i + 1 == filled.size())) continue;  // an empty raster has one tile
    const int column = int(i % std::size_t(columns)) * edge, row = int(i / std::size_t(columns)) * edge;
    tiles.push_back({raster,
                     column,
                     row,
                     std::min(edge, raster->columns - 1 - column),
                     std::min(edge, raster->rows - 1 - row),
                     {}});
  }
  place_tiles(ground, tiles);
  return tiles;
}

std::vector<DemSurface> surfaces_of(const std::vector<DemOptions>& options, bool is_local) {
  const QuietErrors quiet;
  std::vector<RasterHead> heads;
  for (const DemOptions& o : options) heads.push_back(head_of(o, is_local));
  std::vector<DemSurface> out;
  const std::vector<SurfaceHead> surfaces = group_surfaces(heads);
  warn_of_other_surfaces(surfaces, heads);
  for (const SurfaceHead& surface : surfaces) out.push_back(surface_of(heads, surface));
  return out;
}

DemMesh mesh_of(const DemTile& tile, bool with_ortho) {
  const QuietErrors quiet;
  const DemRaster& raster = *tile.raster;
  const DemOptions& first = raster.parts[0].options;
  const Ground ground(first, *borrow_raster(first.dem, "dem"));
  DemMesh out;
  std::vector<double> height_m = read_heights(tile, ground, out.warnings);
  for (const Point<Scene>& p : places(tile, ground, height_m, out.warnings)) {
    const double xyz[3] = {p.x, p.y, p.z};
    for (std::size_t c = 0; c < 3; ++c)
      out.primitive.position.push_back(float(std::floor(xyz[c] / quantum_m + 0.5) * quantum_m - tile.offset_m[c]));
  }
  add_triangles(tile, height_m, Grid{raster.geotransform}.determinant() < 0, out.primitive);
  out.material.double_sided = out.material.unlit = true;
  const bool has_ortho = std::any_of(raster.parts.begin(), raster.parts.end(),
                                     [](const DemPart& part) { return !part.options.ortho.empty(); });
  if (!with_ortho || !has_ortho || out.primitive.index.empty()) return out;
  out.images.push_back(read_ortho(tile, ground.crs()));
  out.material.texture = {0, Wrap::clamp_to_edge, Wrap::clamp_to_edge, false};
  const double texels = raster.texels_per_cell, margin = margin_texels(raster.texels_per_cell) / texels;
  for (int r = 0; r <= tile.rows; ++r)
    for (int c = 0; c <= tile.columns; ++c) {
      out.primitive.uv.push_back(float((c + margin) / (tile.columns + 2 * margin)));
      out.primitive.uv.push_back(float((r + margin) / (tile.rows + 2 * margin)));
    }
  return out;
}

std::vector<Path> files_of(const DemTile& tile) {
  const QuietErrors quiet;
  std::vector<Path> out;
  for (const DemPart& part : tile.raster->parts) {
    if (!touches(tile, part)) continue;
    add_files(part.options.dem, "dem", out);
    if (!part.options.ortho.empty()) add_files(part.options.ortho, "ortho", out);
    for (const Path& grid : part.grids)
      if (std::find(out.begin(), out.end(), grid) == out.end()) out.push_back(grid);
  }
  return out;
}

}  // namespace
}  // namespace gigabake

const gigabake::GdalModule* gigabake_gdal() {
  static const gigabake::GdalModule module{gigabake::set_memory_limit, gigabake::surfaces_of, gigabake::mesh_of,
                                           gigabake::files_of, gigabake::gdal_crs_map};
  return &module;
}
