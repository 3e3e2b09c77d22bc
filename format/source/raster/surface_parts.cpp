#include "format/source/raster/surface_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gigabake {
namespace {

/// The max deviation between equal pixel grids, in pixels over the whole width. Geotransforms are rounded numbers.
constexpr double max_offset_pixels = 0.02;
/// The max distance between rasters of one surface, in pixels, because the size of a surface must fit into an int.
constexpr double max_distance_pixels = 1e8;

bool is_same_crs(const RasterHead& a, const RasterHead& b) {
  if (!a.crs || !b.crs) return !a.crs && !b.crs;
  return a.crs->IsSame(&*b.crs) != 0;
}

/// Returns the column and row of b's first pixel in the grid of `a`; nullopt if the grids differ.
std::optional<std::pair<int, int>> offset_of(const RasterHead& a, const RasterHead& b) {
  const double maximum = std::max({a.part.columns, a.part.rows, b.part.columns, b.part.rows});
  const double determinant = a.grid.determinant(), pixel = std::sqrt(std::fabs(determinant));
  for (const std::size_t i : {1, 2, 4, 5})
    if (!(std::fabs(a.grid.g[i] - b.grid.g[i]) * maximum <= max_offset_pixels * pixel)) return std::nullopt;
  const double dx = b.grid.g[0] - a.grid.g[0], dy = b.grid.g[3] - a.grid.g[3];
  const double column = (dx * a.grid.g[5] - dy * a.grid.g[2]) / determinant;
  const double row = (dy * a.grid.g[1] - dx * a.grid.g[4]) / determinant;
  for (const double at : {column, row})
    if (!(std::fabs(at) <= max_distance_pixels) || std::fabs(at - std::round(at)) > max_offset_pixels)
      return std::nullopt;
  return std::pair(int(std::lround(column)), int(std::lround(row)));
}

/// Moves the origin of a surface's grid from the first part to the first column and row of all parts. Sets the size of
/// the surface.
void settle(SurfaceHead& surface, std::vector<RasterHead>& heads) {
  int column = 0, row = 0;
  for (const std::size_t i : surface.heads)
    column = std::min(column, heads[i].part.column), row = std::min(row, heads[i].part.row);
  Grid& grid = surface.grid;
  grid.g[0] += grid.g[1] * column + grid.g[2] * row;
  grid.g[3] += grid.g[4] * column + grid.g[5] * row;
  for (const std::size_t i : surface.heads) {
    DemPart& part = heads[i].part;
    part.column -= column, part.row -= row;
    surface.columns = std::max(surface.columns, part.column + part.columns);
    surface.rows = std::max(surface.rows, part.row + part.rows);
  }
}

/// Returns whether two rasters overlap or are less than two pixels apart.
bool are_close(const RasterHead& a, const RasterHead& b) {
  for (const std::size_t axis : {0, 1}) {
    const auto pixel = [&](const RasterHead& head) {
      return (head.bounds[axis + 2] - head.bounds[axis]) / ((axis == 0 ? head.part.columns : head.part.rows) - 1);
    };
    const double margin = 2 * std::max(pixel(a), pixel(b));
    if (a.bounds[axis] > b.bounds[axis + 2] + margin || b.bounds[axis] > a.bounds[axis + 2] + margin) return false;
  }
  return true;
}

}  // namespace

void warn_of_other_surfaces(const std::vector<SurfaceHead>& surfaces, std::vector<RasterHead>& heads) {
  std::vector<std::size_t> surface_of(heads.size(), 0);
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    for (const std::size_t head : surfaces[s].heads) surface_of[head] = s;
  for (std::size_t i = 0; surfaces.size() > 1 && i < heads.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (surface_of[i] != surface_of[j] && are_close(heads[i], heads[j])) {
        heads[i].part.warnings.push_back("touches or overlaps " +
                                         in_quotes(heads[j].part.options.dem.filename().string()) +
                                         ", whose pixels lie on another grid: each is baked unchanged, with a gap or "
                                         "two surfaces there; resample both "
                                         "to one grid with gdalwarp -t_srs -tr -tap");
        break;
      }
}

std::vector<SurfaceHead> group_surfaces(std::vector<RasterHead>& heads) {
  std::vector<SurfaceHead> surfaces;
  for (std::size_t i = 0; i < heads.size(); ++i) {
    bool is_added = false;
    for (SurfaceHead& surface : surfaces) {
      const RasterHead& first = heads[surface.heads[0]];
      if (is_added || !is_same_crs(first, heads[i])) continue;
      const auto offset = offset_of(first, heads[i]);
      if (!offset) continue;
      heads[i].part.column = offset->first, heads[i].part.row = offset->second;
      surface.heads.push_back(i);
      is_added = true;
    }
    if (!is_added) surfaces.push_back({heads[i].grid, 0, 0, {i}});
  }
  for (SurfaceHead& surface : surfaces) settle(surface, heads);
  return surfaces;
}

}  // namespace gigabake
