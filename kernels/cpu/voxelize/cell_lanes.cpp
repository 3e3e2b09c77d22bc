#include "kernels/cpu/voxelize/cell_lanes.h"

namespace gigabake::kernels {
namespace {

/// The sums of one group of lanes. They are local, so that compilers keep them in registers while edges are added.
struct GroupMoments {
  GroupMoments() {
    for (int i = 0; i < lane_group; ++i) area[i] = u[i] = v[i] = uu[i] = uv[i] = vv[i] = 0;
  }
  double area[lane_group], u[lane_group], v[lane_group];
  float uu[lane_group], uv[lane_group], vv[lane_group];
};

template <Moments wanted>
void add_edge_to_group(const TrianglePlane& plane, const SlabPolygon& polygon, int e, const double* u, const double* v,
                       GroupMoments& sum) {
  const int f = e + 1 == polygon.count ? 0 : e + 1;
  const double eu = polygon.u[e], ev = polygon.v[e], fv = polygon.v[f];
  if (ev == fv) return;  // horizontal edges do not contribute to ∮ u dv
  const Line line = plane.line[polygon.line[e]];
  for (int i = 0; i < lane_group; ++i) {
    CellMoments m{sum.area[i], sum.u[i], sum.v[i], sum.uu[i], sum.uv[i], sum.vv[i]};
    add_edge<wanted>(eu - u[i], ev - v[i], fv - v[i], line, m);
    sum.area[i] = m.area;
    sum.u[i] = m.u;
    sum.v[i] = m.v;
    sum.uu[i] = m.uu;
    sum.uv[i] = m.uv;
    sum.vv[i] = m.vv;
  }
}

template <Moments wanted>
void measure(const TrianglePlane& plane, const SlabPolygon& polygon, CellLanes& lanes) {
  for (int i = 0; i < lane_group; ++i) lanes.u[lanes.count + i] = lanes.v[lanes.count + i] = 0;
  for (int at = 0; at < lanes.count; at += lane_group) {
    GroupMoments sum;
    for (int e = 0; e < polygon.count; ++e)
      add_edge_to_group<wanted>(plane, polygon, e, lanes.u + at, lanes.v + at, sum);
    for (int i = 0; i < lane_group; ++i) {
      lanes.area[at + i] = sum.area[i];
      lanes.moment_u[at + i] = sum.u[i];
      lanes.moment_v[at + i] = sum.v[i];
      if constexpr (wanted != Moments::second) continue;
      lanes.moment_uu[at + i] = sum.uu[i];
      lanes.moment_uv[at + i] = sum.uv[i];
      lanes.moment_vv[at + i] = sum.vv[i];
    }
  }
}

}  // namespace

void measure_areas(const TrianglePlane& plane, const SlabPolygon& polygon, CellLanes& lanes) {
  measure<Moments::area>(plane, polygon, lanes);
}

void measure_moments(const TrianglePlane& plane, const SlabPolygon& polygon, CellLanes& lanes) {
  measure<Moments::first>(plane, polygon, lanes);
}

void measure_second_moments(const TrianglePlane& plane, const SlabPolygon& polygon, CellLanes& lanes) {
  measure<Moments::second>(plane, polygon, lanes);
}

}  // namespace gigabake::kernels
