#include "kernels/cell_lanes.h"

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

void measure_areas(const SlabPolygon& polygon, CellLanes& lanes) {
  const int padded = padded_count(lanes);
  for (int e = 0; e < polygon.count; ++e) {
    const int f = e + 1 == polygon.count ? 0 : e + 1;
    const double slope = edge_slope(polygon, e), eu = polygon.u[e], ev = polygon.v[e], fu = polygon.u[f],
                 fv = polygon.v[f];
    if (ev == fv) continue;  // level edges bound no area in ∮ u dv
    for (int i = 0; i < padded; ++i) {
      CellMoments m{lanes.area[i], 0, 0};
      add_edge<false>(eu - lanes.u[i], ev - lanes.v[i], fu - lanes.u[i], fv - lanes.v[i], slope, m);
      lanes.area[i] = m.area;
    }
  }
}

void measure_moments(const SlabPolygon& polygon, CellLanes& lanes) {
  const int padded = padded_count(lanes);
  for (int e = 0; e < polygon.count; ++e) {
    const int f = e + 1 == polygon.count ? 0 : e + 1;
    const double slope = edge_slope(polygon, e), eu = polygon.u[e], ev = polygon.v[e], fu = polygon.u[f],
                 fv = polygon.v[f];
    if (ev == fv) continue;
    for (int i = 0; i < padded; ++i) {
      CellMoments m{lanes.area[i], lanes.moment_u[i], lanes.moment_v[i]};
      add_edge<true>(eu - lanes.u[i], ev - lanes.v[i], fu - lanes.u[i], fv - lanes.v[i], slope, m);
      lanes.area[i] = m.area;
      lanes.moment_u[i] = m.u;
      lanes.moment_v[i] = m.v;
    }
  }
}

void mean_vertex_colours(const Surface& surface, const TrianglePlane& plane, const CellLanes& lanes,
                         double mean[4][64]) {
  const int padded = (lanes.count + lane_group - 1) / lane_group * lane_group;
  const Surface s = surface;  // copies: the stores below cannot change them
  const TrianglePlane t = plane;
  for (int i = 0; i < padded; ++i) {
    const CellMoments m{lanes.area[i], lanes.moment_u[i], lanes.moment_v[i]};
    const Barycentric w = barycentric(t, centroid_of(m, lanes.u[i], lanes.v[i]));
    mean[0][i] = vertex_mean(s, 0, w);
    mean[1][i] = vertex_mean(s, 1, w);
    mean[2][i] = vertex_mean(s, 2, w);
    mean[3][i] = vertex_mean(s, 3, w);
  }
}

}  // namespace gigabake::kernels
