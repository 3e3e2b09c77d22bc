#include "query/volume/column_area.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <utility>

#include "core/base/error.h"
#include "core/math/georeference.h"

namespace gigabake {
namespace {

/// The fraction of the area's extent by which its box is grown. The edges of a polygon, which are straight in degrees,
/// deviate by less from straight lines in the scene.
constexpr double edge_deviation = 0.25;
constexpr std::int64_t min_reach_columns = 4096;
/// Vertices this far below the scene's plane are on the other side of the earth.
constexpr double min_vertex_z_m = -1e6;

/// A box on the plane z = 0 of the scene.
struct PlaneBox {
  std::array<double, 2> low{}, high{};
};

/// Returns the box of all vertices of the area; infinite if a vertex is on the other side of the earth.
PlaneBox box_of_vertices(const Area& area, const Geodetic& origin) {
  const Affine<Scene, Ecef> to_scene = scene_from_ecef(origin);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  PlaneBox box{{infinity, infinity}, {-infinity, -infinity}};
  for (const AreaPolygon& polygon : area.polygons)
    for (const FixedPoint& vertex : polygon.rings()[0]) {
      const Geodetic place{double(vertex.y) / fixed_per_unit, double(vertex.x) / fixed_per_unit, origin.height_m};
      const Point<Scene> p = to_scene(ecef_of(place));
      const std::array<double, 2> at{p.x, p.y};
      for (std::size_t a = 0; a < 2; ++a) {
        box.low[a] = p.z < min_vertex_z_m ? -infinity : std::min(box.low[a], at[a]);
        box.high[a] = p.z < min_vertex_z_m ? infinity : std::max(box.high[a], at[a]);
      }
    }
  const double margin = edge_deviation * std::max(box.high[0] - box.low[0], box.high[1] - box.low[1]);
  for (std::size_t a = 0; a < 2; ++a) box.low[a] -= margin, box.high[a] += margin;
  return box;
}

}  // namespace

ColumnArea::ColumnArea(std::shared_ptr<const Area> area, const SceneHeader& scene, const kernels::VoxelBox& window,
                       int lod)
    : frame_{scene.voxel_size_m, scene.lattice_origin_m},
      column_m_(std::ldexp(scene.voxel_size_m, lod)),
      area_(area, scene.origin) {
  std::int64_t reach = min_reach_columns;
  for (std::size_t a = 0; a < 2; ++a) {
    window_min_[a] = window.min[a] >> lod;
    window_end_[a] = ((window.max[a] - 1) >> lod) + 1;
    reach = std::max(reach, window_end_[a] - window_min_[a]);
  }
  const PlaneBox box = box_of_vertices(*area, *scene.origin);
  for (std::size_t a = 0; a < 2; ++a) {
    const double low = std::floor((box.low[a] - frame_.lattice_origin_m[a]) / column_m_) - 1,
                 high = std::ceil((box.high[a] - frame_.lattice_origin_m[a]) / column_m_) + 1;
    if (low < double(window_min_[a] - 2 * reach) || high > double(window_end_[a] + 2 * reach))
      throw UsageError("volume",
                       fmt::format("the area reaches more than {:g} m beyond the scene; cut it to the scene's bounds "
                                   "(gigabake info prints them)",
                                   double(reach) * column_m_));
    min_[a] = std::int64_t(low);
    end_[a] = std::int64_t(high);
  }
}

double ColumnArea::centre_m(std::size_t axis, std::int64_t column) const {
  return frame_.lattice_origin_m[axis] + (double(column) + 0.5) * column_m_;
}

/// Classifies the columns of a square and the columns around it.
AreaOverlap ColumnArea::overlap(const Block& min, std::int64_t edge) const {
  return area_.overlap(SceneRange{{centre_m(0, min[0] - 1), centre_m(1, min[1] - 1), 0},
                                  {centre_m(0, min[0] + edge), centre_m(1, min[1] + edge), 0}});
}

bool ColumnArea::is_outside_window(const Block& min, std::int64_t edge) const {
  for (std::size_t a = 0; a < 2; ++a)
    if (min[a] + edge <= window_min_[a] || min[a] >= window_end_[a]) return true;
  return false;
}

std::uint64_t ColumnArea::visit_blocks(const Block& min, std::int64_t edge,
                                       const std::function<void(const Block&)>& visit) const {
  const AreaOverlap whole = overlap(min, edge);
  if (whole == AreaOverlap::outside) return 0;
  if (whole == AreaOverlap::inside && is_outside_window(min, edge)) return std::uint64_t(edge) * std::uint64_t(edge);
  if (edge == block_edge) {
    visit(min);
    return 0;
  }
  std::uint64_t beyond = 0;
  for (const std::int64_t y : {min[1], min[1] + edge / 2})
    for (const std::int64_t x : {min[0], min[0] + edge / 2}) beyond += visit_blocks({x, y}, edge / 2, visit);
  return beyond;
}

std::uint64_t ColumnArea::for_each_block(const std::function<void(const Block&)>& visit) const {
  std::int64_t edge = block_edge;
  while (edge < std::max(end_[0] - min_[0], end_[1] - min_[1])) edge *= 2;
  return visit_blocks(min_, edge, visit);
}

std::vector<AreaColumn> ColumnArea::columns_in(const Block& block) const {
  constexpr std::int64_t row = block_edge + 2;  // includes the adjacent columns
  const AreaOverlap whole = overlap(block, block_edge);
  if (whole == AreaOverlap::outside) return {};
  std::vector<std::uint8_t> is_inside(row * row, 1);
  for (std::int64_t y = 0; y < row && whole == AreaOverlap::border; ++y)
    for (std::int64_t x = 0; x < row; ++x)
      is_inside[std::size_t(y * row + x)] =
          area_.contains({centre_m(0, block[0] + x - 1), centre_m(1, block[1] + y - 1), 0}) ? 1 : 0;
  std::vector<AreaColumn> columns;
  for (std::int64_t y = 1; y <= block_edge; ++y)
    for (std::int64_t x = 1; x <= block_edge; ++x) {
      const std::uint8_t* const at = &is_inside[std::size_t(y * row + x)];
      if (*at == 0) continue;
      const bool is_at_outline = at[-1] + at[1] + at[-row] + at[row] < 4;
      columns.push_back({centre_m(0, block[0] + x - 1), centre_m(1, block[1] + y - 1), is_at_outline});
    }
  return columns;
}

}  // namespace gigabake
