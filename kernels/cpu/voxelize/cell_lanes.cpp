#include "kernels/cpu/voxelize/cell_lanes.h"

#include <cstring>

namespace gigabake::kernels {
namespace {

using GroupMoments = MomentsOf<DoubleLanes, FloatLanes>;

DoubleLanes load(const double* values) {
  DoubleLanes lanes;
  std::memcpy(&lanes, values, sizeof lanes);
  return lanes;
}

template <class Lanes, class Value>
void store(const Lanes& lanes, Value* values) {
  std::memcpy(values, &lanes, sizeof lanes);
}

template <Moments wanted>
GroupMoments moments_of_group(const TrianglePlane& plane, const SlabPolygon& polygon, DoubleLanes u, DoubleLanes v) {
  const DoubleLanes zero{};
  const FloatLanes narrow_zero{};
  GroupMoments sum;
  sum.area = sum.u = sum.v = zero;
  sum.uu = sum.uv = sum.vv = narrow_zero;
  for (int e = 0; e < polygon.count; ++e) {
    const int f = e + 1 == polygon.count ? 0 : e + 1;
    const double eu = polygon.u[e], ev = polygon.v[e], fv = polygon.v[f];
    if (ev == fv) continue;  // horizontal edges do not contribute to ∮ u dv
    const Line line = plane.line[polygon.line[e]];
    add_edge<wanted>(eu - u, ev - v, fv - v, line, sum);
  }
  return sum;
}

template <Moments wanted>
void measure(const TrianglePlane& plane, const SlabPolygon& polygon, CellLanes& lanes) {
  for (int i = 0; i < lane_group; ++i) lanes.u[lanes.count + i] = lanes.v[lanes.count + i] = 0;
  for (int at = 0; at < lanes.count; at += lane_group) {
    const GroupMoments sum = moments_of_group<wanted>(plane, polygon, load(lanes.u + at), load(lanes.v + at));
    store(sum.area, lanes.area + at);
    store(sum.u, lanes.moment_u + at);
    store(sum.v, lanes.moment_v + at);
    if constexpr (wanted != Moments::second) continue;
    store(sum.uu, lanes.moment_uu + at);
    store(sum.uv, lanes.moment_uv + at);
    store(sum.vv, lanes.moment_vv + at);
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
