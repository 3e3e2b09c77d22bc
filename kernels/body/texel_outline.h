/// A fragment's own outline, on its voxel and on its texture, and how much of a texel lies inside it.
///
/// Space   (u, v) of the cell; images from the fragment's centroid; then texels, or parts of them, from the first one
///         that the fragment may meet.
/// Exact   IEEE double without contraction: host and device agree.
#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/body/brick_triangle.h"
#include "kernels/body/coverage.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

/// A fragment as a polygon, in voxels from its cell's lowest corner: a slab's has at most five corners, and each side
/// of the cell adds at most one.
struct Outline {
  static constexpr int most = 9;
  Point2 at[most];
  int count;

  GB_HD void add(Point2 p) {
    if (count < most) at[count++] = p;  // rounding may bend a sliver, and so cut it once more
  }
};

/// How far a point is inside one of the four sides of the unit cell.
GB_HD double depth_in_cell(Point2 p, int side) {
  const double x = side < 2 ? p.u : p.v;
  return (side & 1) == 0 ? x : 1 - x;
}

GB_HD Outline cut_by_side(const Outline& from, int side) {
  Outline r;
  r.count = 0;
  for (int i = 0; i < from.count; ++i) {
    const Point2 a = from.at[i], b = from.at[i + 1 == from.count ? 0 : i + 1];
    const double da = depth_in_cell(a, side), db = depth_in_cell(b, side);
    if (da >= 0) r.add(a);
    if ((da < 0) == (db < 0)) continue;
    const double t = da / (da - db);
    r.add({a.u + (b.u - a.u) * t, a.v + (b.v - a.v) * t});
  }
  return r;
}

GB_HD Outline outline_of(const FragmentShape& f) {
  Outline r;
  r.count = 0;
  for (int i = 0; i < f.corners; ++i) r.add({f.polygon_u[i] - f.cell_u, f.polygon_v[i] - f.cell_v});
  GB_NO_UNROLL
  for (int side = 0; side < 4; ++side) r = cut_by_side(r, side);
  return r;
}

/// How (s, t) runs over a fragment's (u, v). A map that is flat, as those of colours along a line are, gets a
/// thousandth of its length as width, so that what it shows has an area.
struct FragmentMap {
  double su, sv, tu, tv, determinant;
};

GB_HD FragmentMap fragment_map(double su, double sv, double tu, double tv, double width, double height) {
  constexpr double least = 1.0 / 1024;
  double xu = su * width, xv = sv * width, yu = tu * height, yv = tv * height;
  const double along_u = xu * xu + yu * yu, along_v = xv * xv + yv * yv, longer = larger(along_u, along_v);
  const double determinant = xu * yv - xv * yu, across = determinant < 0 ? -least : least;
  if (std::fabs(determinant) < least * longer) {
    const bool moves_v = along_u >= along_v;
    const double dx = across * (moves_v ? -yu : yv), dy = across * (moves_v ? xu : -xv);
    (moves_v ? xv : xu) += dx;
    (moves_v ? yv : yu) += dy;
  }
  return {xu / width, xv / width, yu / height, yv / height, (xu * yv - xv * yu) / (width * height)};
}

/// A fragment's corners on the texture, relative to its centroid; in images, then in texels.
struct TexelOutline {
  double x[Outline::most], y[Outline::most];
  Line line[Outline::most];
  double low_x, high_x, low_y, high_y;
  int count;
};

/// Into `r`, not as a result: nvcc 13.0 puts a result's corners where `o` lies, and overwrites its fifth before it is
/// read. Found on 2026-11-23, in colours of a device (DeviceTextures) and then in its PTX.
GB_HD void map_outline(const Outline& o, const FragmentMap& map, Point2 centroid, TexelOutline& r) {
  r.low_x = r.high_x = r.low_y = r.high_y = 0;
  r.count = o.count;
  for (int i = 0; i < o.count; ++i) {
    const double du = o.at[i].u - centroid.u, dv = o.at[i].v - centroid.v;
    r.x[i] = map.su * du + map.sv * dv;
    r.y[i] = map.tu * du + map.tv * dv;
    r.low_x = smaller(r.low_x, r.x[i]);
    r.high_x = larger(r.high_x, r.x[i]);
    r.low_y = smaller(r.low_y, r.y[i]);
    r.high_y = larger(r.high_y, r.y[i]);
  }
}

/// From images around the centroid to texels. (x, y): the centroid; (width, height): of an image.
GB_HD void place_outline(double x, double y, double width, double height, TexelOutline& o) {
  for (int i = 0; i < o.count; ++i) {
    o.x[i] = x + o.x[i] * width;
    o.y[i] = y + o.y[i] * height;
  }
  for (int i = 0; i < o.count; ++i) {
    const int j = i + 1 == o.count ? 0 : i + 1;
    o.line[i] = line_along(o.x[j] - o.x[i], o.y[j] - o.y[i]);
  }
}

/// Bit i: edge i passes through the row of texels.
GB_HD unsigned edges_in_row(const TexelOutline& o, double row) {
  unsigned edges = 0;
  for (int i = 0; i < o.count; ++i) {
    const double a = o.y[i], b = o.y[i + 1 == o.count ? 0 : i + 1];
    if (larger(a, b) > row && smaller(a, b) < row + 1 && a != b) edges |= 1u << i;
  }
  return edges;
}

/// Adds a piece of the texel's right border: what an edge beyond it leaves of the texel.
template <Moments wanted>
GB_HD void add_border(double a, double b, CellMoments& sum) {
  const double dv = b - a;
  sum.area += dv;
  if constexpr (wanted == Moments::area) return;
  const double half = 0.5 * dv * (a + b);
  sum.u += 0.5 * dv;
  sum.v += half;
  sum.uv += 0.5 * half;
}

/// Of a texel: how much is covered, signed as the outline turns, and its moments. Edges left of the texel bound nothing
/// of it, and those on its right all that they pass of its row: most do either.
template <Moments wanted>
GB_HD CellMoments covered_part(const TexelOutline& o, unsigned edges, double column, double row) {
  CellMoments sum{};
  for (int i = 0; i < o.count; ++i) {
    const int j = i + 1 == o.count ? 0 : i + 1;
    if ((edges >> i & 1) == 0 || larger(o.x[i], o.x[j]) <= column) continue;
    if (smaller(o.x[i], o.x[j]) >= column + 1)
      add_border<wanted>(clamp01(o.y[i] - row), clamp01(o.y[j] - row), sum);
    else
      add_edge<wanted>(o.x[i] - column, o.y[i] - row, o.y[j] - row, o.line[i], sum);
  }
  return sum;
}

}  // namespace gigabake::kernels
