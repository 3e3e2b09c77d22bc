/// Area and centroid of a triangle inside a voxel, computed without clipping the polygon per voxel.
///
/// The triangle is cut once per slab of voxels along its dominant axis, to a polygon with at most five corners. Green's
/// theorem then gives the area inside a cell's u range: ∮ clamp(u) dv over the slab polygon's edges, with u clamped to
/// the cell. Clamping v also restricts the area to the cell's v range. No branch depends on the cell, so each lane of a
/// warp can compute a different cell.
///
/// Space   Voxels relative to the triangle's anchor, the voxel of its lowest corner. A fragment's numbers depend on the
///         triangle and on the voxel relative to it, never on bricks, cells or the lattice's origin.
/// Exact   IEEE double without contraction: host and device return the same bits. The error of an area is below 1e-9
///         voxel² for triangles up to 10⁶ voxels wide, and below 1e-14 for triangles of a few voxels.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/rounding.h"
#include "core/math/vec3.h"
#include "core/octree/brick.h"
#include "kernels/body/voxelize/brick_triangle.h"

namespace gigabake::kernels {

/// Slopes of a straight line in (u, v). For a horizontal or vertical line one slope is 0 and the other is undefined; no
/// result depends on the undefined slope.
struct Line {
  double du_dv, dv_du;
};

/// Slab polygon of a triangle, projected on (u, v). It is counter-clockwise if the w component of the triangle's normal
/// is positive, else clockwise. Edge i goes from corner i to the next corner, along TrianglePlane::line[line[i]].
struct SlabPolygon {
  double u[5], v[5];
  int line[5];
  int count;
};

/// Values that all voxels of a triangle share.
struct TrianglePlane {
  double u[3], v[3], w[3];    ///< vertices in voxels from the anchor
  Vec3i64 anchor;             ///< (u, v, w) voxel of the lowest corner, relative to the brick
  double inverse_twice_area;  ///< 1 / (2 · projected area), signed; computed from the exact normal, because products
                              ///< of u and v would lose it to rounding on long slivers
  double weight_scale;        ///< weight per projected (u, v) area, signed: makes clockwise areas positive
  Line line[4];               ///< lines of the three edges, and of any cut by a plane w = constant
  double du_dw[3], dv_dw[3];  ///< slopes of the edges; undefined if w is constant along the edge
  double dw_du, dw_dv;        ///< slopes of the plane
};
inline constexpr int cut_line = 3;

/// Returns 1/x, or 1 for x = 0. The zero test is part of the divisor, so that x = 0 does not divide by zero. A device
/// takes a slow path for a division by zero, even if its result is not selected.
GB_HD double inverse_or_one(double x) { return 1 / (x + (x == 0 ? 1.0 : 0.0)); }

/// Returns both slopes of a line along (du, dv) with one division.
GB_HD Line line_along(double du, double dv) {
  const double inverse = inverse_or_one(du * dv);
  return {du * du * inverse, dv * dv * inverse};
}

/// Fractional bits of fragment weights: areas in multiples of 2^-36 voxel², min 1.
inline constexpr int weight_bits = 36;

template <class I, class N>
GB_HD TrianglePlane make_plane(const BrickTriangle<I, N>& t) {
  using D = typename Coordinate<I>::type;
  TrianglePlane r;
  const Vec3<I> anchor = min_by_axis(min_by_axis(t.p[0], t.p[1]), t.p[2]) >> subvoxel_bits;
  r.anchor = static_cast<Vec3i64>(anchor);
  for (int i = 0; i < 3; ++i) {
    const auto from_anchor = static_cast<Vec3<D>>(t.p[i] - anchor * I(subvoxels));
    const Vec3d p = static_cast<Vec3d>(from_anchor) / double(subvoxels);
    r.u[i] = p[0];
    r.v[i] = p[1];
    r.w[i] = p[2];
  }
  const double nu = double(t.n[0]), nv = double(t.n[1]), nw = double(t.n[2]), inverse = 1 / nw;
  r.inverse_twice_area = double(subvoxels * subvoxels) * inverse;
  r.weight_scale = std::sqrt((nu * nu + nv * nv) + nw * nw) * inverse * double(std::int64_t(1) << weight_bits);
  for (int p = 0; p < 3; ++p) {
    const int q = p == 2 ? 0 : p + 1;
    const double du = r.u[q] - r.u[p], dv = r.v[q] - r.v[p], dw = r.w[q] - r.w[p], per_w = inverse_or_one(dw);
    r.line[p] = line_along(du, dv);
    r.du_dw[p] = du * per_w;
    r.dv_dw[p] = dv * per_w;
  }
  r.line[cut_line] = line_along(-nv, nu);
  r.dw_du = -nu * inverse;
  r.dw_dv = -nv * inverse;
  return r;
}

/// Cuts the triangle to slab ≤ w ≤ slab + 1, in voxels from the anchor. Calls add(u, v, line) for each of the at most
/// five corners of the result. `line` is the line of the edge that starts at the corner. Intersections are computed
/// even if they are not used, so that the lanes of a warp do not diverge.
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
    const bool rising = wp < wq;
    const bool leaves = (wp == high && rising) || (wp == low && wq < wp);
    if (wp >= low && wp <= high) add(t.u[p], t.v[p], leaves ? cut_line : p);
    if (crosses_low && rising) add(t.u[p] + (low - wp) * t.du_dw[p], t.v[p] + (low - wp) * t.dv_dw[p], p);
    if (crosses_high) add(t.u[p] + (high - wp) * t.du_dw[p], t.v[p] + (high - wp) * t.dv_dw[p], rising ? cut_line : p);
    if (crosses_low && !rising) add(t.u[p] + (low - wp) * t.du_dw[p], t.v[p] + (low - wp) * t.dv_dw[p], cut_line);
  }
}

GB_HD SlabPolygon cut_slab(const TrianglePlane& t, double slab) {
  SlabPolygon r;
  r.count = 0;
  cut_slab(t, slab, [&r](double u, double v, int line) {
    r.u[r.count] = u;
    r.v[r.count] = v;
    r.line[r.count] = line;
    ++r.count;
  });
  return r;
}

/// Area, first and second moments of a polygon inside one cell, in projected voxel units relative to the cell's lowest
/// corner. Real and Narrow are double and float, or the same for several cells at once (kernels/cpu/voxelize/lanes.h).
template <class Real, class Narrow>
struct MomentsOf {
  Real area, u, v;
  Narrow uu, uv, vv;  ///< 12, 24 and 12 times the second moments; float suffices for the width of a footprint
};
using CellMoments = MomentsOf<double, float>;

/// Highest order of moments that the caller needs. Higher moments stay 0.
enum class Moments : std::uint8_t { area, first, second };

struct Point2 {
  double u, v;
};

/// Position and shape of a fragment, for shading it.
struct FragmentShape {
  Point2 centroid;
  double area;       ///< projected area, signed, voxel²
  float uu, uv, vv;  ///< variances and covariance of its points, voxel²; 0 if it is too small to measure
  double cell_u, cell_v;
  const double *polygon_u, *polygon_v;  ///< corners of the slab polygon that contains the fragment
  int corners;
};

/// Min projected area (voxel²) at which the centroid is computed as moment over area. Below it, rounding dominates.
inline constexpr double min_centroid_area = 1e-9;

/// Returns true if the fragment is large enough to compute its centroid as moment over area.
GB_HD bool has_centroid(double projected_area) { return std::fabs(projected_area) >= min_centroid_area; }

GB_HD double clamp01(double x) { return x < 0 ? 0 : (x > 1 ? 1 : x); }

/// Returns clamp01(x) for a finite x; the sign of zero may be lost. A device compares the bits as integers, because
/// comparing and selecting doubles is slower. A host compiles the two comparisons to one maximum and one minimum
/// instruction.
GB_HD double clamp01_finite(double x) {
#if defined(__CUDA_ARCH__)
  constexpr int one = 0x3ff00000;
  const int high = __double2hiint(x);
  return __hiloint2double(min(max(high, 0), one), unsigned(high) < unsigned(one) ? __double2loint(x) : 0);
#else
  const double positive = x > 0 ? x : 0;
  return positive < 1 ? positive : 1;
#endif
}

GB_HD double at_most(double x, double high) { return x > high ? high : x; }

GB_HD double select(bool condition, double a, double b) { return condition ? a : b; }
GB_HD double value_or_zero(bool condition, double a) { return condition ? a : 0; }
GB_HD float rounded_to_float(double x) { return float(x); }

/// Adds the second moments of an edge. The part inside the cell leads from (ca, v_in) to (cb, v_in + dv_in). The part
/// with u > 1 is clamped to u = 1 and leads from v_hi to v_hi + dv_hi.
template <class Real, class Narrow>
GB_HD void add_second_moments(Narrow ca, Narrow cb, Narrow v_in, Narrow dv_in, Narrow v_hi, Narrow dv_hi,
                              MomentsOf<Real, Narrow>& sum) {
  const Narrow v_out = v_in + dv_in, v_top = v_hi + dv_hi;
  const Narrow aa = ca * ca, bb = cb * cb, c = ca + cb, v = v_in + v_out, middle = v_hi + v_top;
  sum.uu += c * (aa + bb) * dv_in + 4.0f * dv_hi;
  sum.uv += (2.0f * (aa * v_in + bb * v_out) + c * c * v) * dv_in + 6.0f * middle * dv_hi;
  sum.vv += (2.0f * (ca * (v_in * v_in) + cb * (v_out * v_out)) + c * (v * v)) * dv_in +
            4.0f * (middle * middle - v_hi * v_top) * dv_hi;
}

/// Adds an edge of a polygon. The edge lies on `line` and leads from (au, av) to v = bv, relative to the cell. Within
/// the cell's range of v, its dv has three parts: u < 0, u inside the cell, and u > 1. The first two parts are computed
/// by dv/du; the third is the remainder. If dv/du is steep, rounding shifts the limits between the parts. An edge
/// inside the cell therefore keeps its dv unchanged.
template <Moments wanted, class Real, class Narrow>
GB_HD void add_edge(Real au, Real av, Real bv, const Line& line, MomentsOf<Real, Narrow>& sum) {
  const Real va = clamp01_finite(av), vb = clamp01_finite(bv);
  const Real ua = au + (va - av) * line.du_dv, ub = au + (vb - av) * line.du_dv;
  const Real ca = clamp01_finite(ua), cb = clamp01_finite(ub);
  const Real dv = vb - va;
  const Real dv_in = select((ca == ua) & (cb == ub), dv, (cb - ca) * line.dv_du);
  const Real dv_lo = (at_most(ub, 0) - at_most(ua, 0)) * line.dv_du;
  const Real dv_hi = value_or_zero((ua > 1) | (ub > 1), (dv - dv_in) - dv_lo);
  sum.area += (ca + cb) * 0.5 * dv_in + dv_hi;
  if constexpr (wanted != Moments::area) {
    const auto falls = ub < ua;
    const Real v_in = va + select(falls, dv_hi, dv_lo), v_out = v_in + dv_in;
    const Real v_hi = select(falls, va, v_out), v_top = v_hi + dv_hi;
    sum.u += (ca * ca + ca * cb + cb * cb) * (1.0 / 6) * dv_in + 0.5 * dv_hi;
    sum.v += (ca * (2.0 * v_in + v_out) + cb * (v_in + 2.0 * v_out)) * (1.0 / 6) * dv_in + 0.5 * dv_hi * (v_hi + v_top);
    if constexpr (wanted == Moments::second)
      add_second_moments(rounded_to_float(ca), rounded_to_float(cb), rounded_to_float(v_in), rounded_to_float(dv_in),
                         rounded_to_float(v_hi), rounded_to_float(dv_hi), sum);
  }
}

GB_HD std::int64_t weight_of(double projected_area, double weight_scale) {
  const double weight = projected_area * weight_scale;
  return weight < 1 ? 1 : floor_to_int64(weight + 0.5);
}

}  // namespace gigabake::kernels
