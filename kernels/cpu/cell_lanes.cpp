#include "kernels/cpu/cell_lanes.h"

namespace gigabake::kernels {
namespace {

constexpr int lane_group = 4;

int padded_count(CellLanes& lanes) {
  const int padded = (lanes.count + lane_group - 1) / lane_group * lane_group;
  for (int i = lanes.count; i < padded; ++i) lanes.u[i] = lanes.v[i] = 0;
  for (int i = 0; i < padded; ++i) lanes.area[i] = lanes.moment_u[i] = lanes.moment_v[i] = 0;
  return padded;
}

}  // namespace

void measure_areas(const TrianglePlane& plane, const SlabPolygon& polygon, CellLanes& lanes) {
  const int padded = padded_count(lanes);
  for (int e = 0; e < polygon.count; ++e) {
    const int f = e + 1 == polygon.count ? 0 : e + 1;
    const double eu = polygon.u[e], ev = polygon.v[e], fv = polygon.v[f];
    if (ev == fv) continue;  // level edges bound no area in ∮ u dv
    const Line line = plane.line[polygon.line[e]];
    for (int i = 0; i < padded; ++i) {
      CellMoments m{lanes.area[i], 0, 0};
      add_edge<false>(eu - lanes.u[i], ev - lanes.v[i], fv - lanes.v[i], line, m);
      lanes.area[i] = m.area;
    }
  }
}

void measure_moments(const TrianglePlane& plane, const SlabPolygon& polygon, CellLanes& lanes) {
  const int padded = padded_count(lanes);
  for (int e = 0; e < polygon.count; ++e) {
    const int f = e + 1 == polygon.count ? 0 : e + 1;
    const double eu = polygon.u[e], ev = polygon.v[e], fv = polygon.v[f];
    if (ev == fv) continue;
    const Line line = plane.line[polygon.line[e]];
    for (int i = 0; i < padded; ++i) {
      CellMoments m{lanes.area[i], lanes.moment_u[i], lanes.moment_v[i]};
      add_edge<true>(eu - lanes.u[i], ev - lanes.v[i], fv - lanes.v[i], line, m);
      lanes.area[i] = m.area;
      lanes.moment_u[i] = m.u;
      lanes.moment_v[i] = m.v;
    }
  }
}

}  // namespace gigabake::kernels
