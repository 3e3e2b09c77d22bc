/// How much of a triangle lies in a voxel, and where: area and centroid of the clipped polygon, without clipping it.
///
/// The triangle is cut once per slab of voxels along its dominant axis (≤ 5 vertices); then, by Green's theorem with
/// the integrand clamped to the cell, ∮ clamp(u) dv over the slab polygon's edges is the area inside the cell's u
/// range, and clamping v as well restricts it to the cell. No branch depends on the cell, so cells are lanes.
///
/// Space   Voxels relative to the triangle's anchor (the voxel of its lowest corner): a fragment's numbers depend on
/// the
///         triangle and on the voxel relative to it, never on bricks, cells or the lattice's origin.
/// Exact   IEEE double without contraction: host and device return the same bits. Error of an area: below 1e-9 voxel²
///         for triangles up to 10⁶ voxels wide, 1e-14 for triangles of some voxels.
#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/brick_triangle.h"
#include "kernels/types.h"

namespace gigabake::kernels {

/// A triangle's slab polygon, projected on (u, v); counter-clockwise if its normal's w is positive, else clockwise.
struct SlabPolygon {
  double u[5], v[5];
  int count;
};

/// What is the same for all voxels of a triangle.
struct TrianglePlane {
  double u[3], v[3], w[3];    ///< vertices in voxels from the anchor
  std::int64_t anchor[3];     ///< (u, v, w) voxel of the lowest corner, relative to the brick
  double inverse_twice_area;  ///< of the projection, signed: the products of u and v round it away on long slivers
  double area_scale;          ///< surface area per projected (u, v) area, signed: makes clockwise areas positive
};

template <class I>
GB_HD TrianglePlane make_plane(const BrickTriangle<I>& t) {
  TrianglePlane r;
  double* out[3] = {r.u, r.v, r.w};
  for (int c = 0; c < 3; ++c) {
    const I lo = smaller(smaller(t.p[0][c], t.p[1][c]), t.p[2][c]);
    const I anchor = floor_voxel(lo);
    r.anchor[c] = std::int64_t(anchor);
    for (int i = 0; i < 3; ++i) out[c][i] = double(std::int64_t(t.p[i][c] - anchor * subvoxels)) / double(subvoxels);
  }
  const double nu = double(t.n[0]), nv = double(t.n[1]), nw = double(t.n[2]);
  r.inverse_twice_area = double(subvoxels * subvoxels) / nw;
  r.area_scale = std::sqrt((nu * nu + nv * nv) + nw * nw) / nw;
  return r;
}

struct CutPoint {
  double u, v;
};

/// Where edge p→q meets w = at; the same point from either end. Meaningless where it does not.
GB_HD CutPoint cross_edge(const TrianglePlane& t, int p, int q, double at) {
  const bool falls = t.w[q] < t.w[p];
  const int a = falls ? q : p, b = falls ? p : q;
  const double share = (at - t.w[a]) / (t.w[b] - t.w[a]);
  return {t.u[a] + (t.u[b] - t.u[a]) * share, t.v[a] + (t.v[b] - t.v[a]) * share};
}

/// The corners of the part of the triangle with slab ≤ w ≤ slab+1 (voxels from the anchor), as seen along w, at most
/// five: add(u, v). Crossings are computed whether they are there or not, so that neighbours in a warp do not wait for
/// each other.
template <class Add>
GB_HD void cut_slab(const TrianglePlane& t, double slab, const Add& add) {
  const double low = slab, high = slab + 1;
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
  for (int p = 0; p < 3; ++p) {
    const int q = p == 2 ? 0 : p + 1;
    const double wp = t.w[p], wq = t.w[q];
    const bool crosses_low = (wp < low) != (wq < low) && wp != low && wq != low;
    const bool crosses_high = (wp > high) != (wq > high) && wp != high && wq != high;
    const CutPoint at_low = cross_edge(t, p, q, low), at_high = cross_edge(t, p, q, high);
    const bool rising = wp < wq;
    if (wp >= low && wp <= high) add(t.u[p], t.v[p]);
    if (crosses_low && rising) add(at_low.u, at_low.v);
    if (crosses_high) add(at_high.u, at_high.v);
    if (crosses_low && !rising) add(at_low.u, at_low.v);
  }
}

GB_HD SlabPolygon cut_slab(const TrianglePlane& t, double slab) {
  SlabPolygon r;
  r.count = 0;
  cut_slab(t, slab, [&r](double u, double v) {
    r.u[r.count] = u;
    r.v[r.count] = v;
    ++r.count;
  });
  return r;
}

/// Area and first moments of a polygon inside one cell, in projected voxel units relative to the cell's lowest corner.
struct CellMoments {
  double area, u, v;
};

GB_HD double clamp01(double x) { return x < 0 ? 0 : (x > 1 ? 1 : x); }
GB_HD double at_least(double x, double low) { return x < low ? low : x; }

/// Adds edge a→b of a polygon. (au, av), (bu, bv): relative to the cell; slope: du/dv of the whole edge, 0 if level.
template <bool with_moments>
GB_HD void add_edge(double au, double av, double bu, double bv, double slope, CellMoments& sum) {
  const double va = clamp01(av), vb = clamp01(bv);
  const double ua = au + (va - av) * slope, ub = bu + (vb - bv) * slope;
  const double dv = vb - va, du = ub - ua;
  const double ca = clamp01(ua), cb = clamp01(ub);
  const double inverse = 1 / (du != 0 ? du : 1);
  const double inside = du != 0 ? (cb - ca) * inverse : 1;                            // share of dv with 0 < u < 1
  const double beyond = du != 0 ? (at_least(ub, 1) - at_least(ua, 1)) * inverse : 0;  // share with u ≥ 1
  const double dv_in = dv * inside, dv_hi = dv * beyond;
  sum.area += (ca + cb) * 0.5 * dv_in + dv_hi;
  if constexpr (with_moments) {
    const double dv_lo = dv - dv_in - dv_hi;
    const double v_in = va + (du < 0 ? dv_hi : dv_lo), v_out = v_in + dv_in;
    const double v_hi = du < 0 ? va : v_out, v_top = v_hi + dv_hi;
    sum.u += (ca * ca + ca * cb + cb * cb) * (1.0 / 6) * dv_in + 0.5 * dv_hi;
    sum.v += (ca * (2 * v_in + v_out) + cb * (v_in + 2 * v_out)) * (1.0 / 6) * dv_in + 0.5 * dv_hi * (v_hi + v_top);
  }
}

/// Slope du/dv that add_edge needs of polygon edge i.
GB_HD double edge_slope(const SlabPolygon& p, int i) {
  const int j = i + 1 == p.count ? 0 : i + 1;
  const double dv = p.v[j] - p.v[i];
  return dv != 0 ? (p.u[j] - p.u[i]) / dv : 0;
}

/// Fragment weights: areas in multiples of 2^-36 voxel², at least one.
inline constexpr int weight_bits = 36;

GB_HD std::int64_t weight_of(double projected_area, double area_scale) {
  const double area = projected_area * area_scale * double(std::int64_t(1) << weight_bits);
  return area < 1 ? 1 : std::int64_t(std::floor(area + 0.5));
}

}  // namespace gigabake::kernels
