/// A triangle in the space of one brick, and the exact test for the voxels of the brick that it overlaps. Axes are
/// permuted so that the largest component of the triangle's normal comes third.
///
/// Space   Brick sub-voxels, axes permuted cyclically: w is the dominant axis of the normal, u and v follow it. Voxel i
///         is the half-open [256 i, 256 (i+1)).
/// Exact   Integers only. I is std::int32_t if every extent is ≤ small_extent, std::int64_t if it is ≤ narrow_extent,
///         else __int128. All three return the same bits.
/// Source  Akenine-Möller 2001, "Fast 3D Triangle-Box Overlap Testing" (13 axes), with open or closed sets; tie rules
///         in docs/accuracy.md.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/base/rules.h"
#include "core/math/vec3.h"
#include "core/octree/brick.h"

namespace gigabake::kernels {

/// Max extent of a triangle, in sub-voxels, for which 32-bit edge functions and normals cannot overflow: they stay
/// below 2^30. Values of the plane equation need 64 bits.
inline constexpr std::int64_t small_extent = 1 << 14;
/// Max extent of a triangle, in sub-voxels, for which 64-bit integers cannot overflow. Edge functions stay below 2^41,
/// and values of the plane equation below 2^61.
inline constexpr std::int64_t narrow_extent = 1 << 19;
/// Max |coordinate| relative to the window, in sub-voxels (4 million voxels): the 128-bit path stays below 2^100.
inline constexpr std::int64_t max_coordinate = 1 << 30;

/// A snapped triangle, relative to its window's lowest corner, in sub-voxels.
struct WindowTriangle {
  Vec3<std::int32_t> p[3];
  std::uint32_t part;   ///< index into CellInput::parts
  std::uint32_t index;  ///< triangle of that part
};

/// Triangle in brick space. N is the type of the normal's components; double is exact if std::int64_t suffices.
template <class I, class N = I>
struct BrickTriangle {
  Vec3<I> p[3];  ///< vertices in (u, v, w)
  Vec3<N> n;     ///< (p1-p0) × (p2-p0); |n[2]| is the max component and not zero
  int axis;      ///< which of x, y, z is w; u = (axis+1)%3, v = (axis+2)%3
};

/// Integer type of values of the plane equation.
template <class I>
struct PlaneInteger {
  using type = I;
};
template <>
struct PlaneInteger<std::int32_t> {
  using type = std::int64_t;
};

/// Integer type that holds coordinates and their differences.
template <class I>
struct Coordinate {
  using type = std::int32_t;
};
template <>
struct Coordinate<__int128> {
  using type = std::int64_t;
};

/// Inclusive range of voxels in the brick; empty if first > last.
struct VoxelRange {
  int first, last;
};

template <class I>
GB_HD I floor_voxel(I subvoxel) {
  return subvoxel >> subvoxel_bits;
}

template <class I>
GB_HD I smaller(I a, I b) {
  return a < b ? a : b;
}

template <class I>
GB_HD I larger(I a, I b) {
  return a < b ? b : a;
}

/// Returns (u, v, w) of (x, y, z), where w is `axis`. Components are selected by comparisons, so that a device indexes
/// nothing at run time.
template <class T>
GB_HD Vec3<T> permuted(const Vec3<T>& xyz, int axis) {
  return Vec3<T>::by_axis(
      [&](int c) { return axis == 2 ? xyz[c] : (axis == 1 ? xyz[(c + 2) % 3] : xyz[(c + 1) % 3]); });
}

/// Returns (x, y, z) of (u, v, w); the inverse of permuted().
template <class T>
GB_HD Vec3<T> unpermuted(const Vec3<T>& uvw, int axis) {
  return Vec3<T>::by_axis(
      [&](int c) { return axis == 2 ? uvw[c] : (axis == 1 ? uvw[(c + 1) % 3] : uvw[(c + 2) % 3]); });
}

/// Converts a triangle to brick space. `corner` is the brick's lowest corner in window sub-voxels. The triangle must
/// have area; classify_triangle() drops triangles without area.
template <class I, class N = I>
GB_HD BrickTriangle<I, N> make_brick_triangle(const WindowTriangle& t, const Vec3<std::int32_t>& corner) {
  using D = Vec3<typename Coordinate<I>::type>;
  D q[3];
  for (int i = 0; i < 3; ++i) q[i] = static_cast<D>(t.p[i]) - static_cast<D>(corner);
  const auto n = cross(static_cast<Vec3<N>>(q[1] - q[0]), static_cast<Vec3<N>>(q[2] - q[0]));
  const auto m = Vec3<N>::by_axis([&](int c) { return n[c] < 0 ? -n[c] : n[c]; });
  BrickTriangle<I, N> r;
  r.axis = m[2] >= m[1] ? (m[2] >= m[0] ? 2 : 0) : (m[1] >= m[0] ? 1 : 0);
  for (int i = 0; i < 3; ++i) r.p[i] = static_cast<Vec3<I>>(permuted(q[i], r.axis));
  r.n = permuted(n, r.axis);
  return r;
}

/// Returns the voxels of the brick within the triangle's extent along one axis. If `closed`, contact counts as overlap.
template <class I>
GB_HD VoxelRange extent_voxels(const BrickTriangle<I>& t, int c, bool closed) {
  const I lo = smaller(smaller(t.p[0][c], t.p[1][c]), t.p[2][c]);
  const I hi = larger(larger(t.p[0][c], t.p[1][c]), t.p[2][c]);
  // Open: [floor(lo), ceil(hi)-1]; an extent of length 0 on a border belongs to the voxel above it. Closed: one more
  // voxel at exact contact.
  I first = floor_voxel(closed ? lo - 1 : lo), last = floor_voxel(closed || hi == lo ? hi : hi - 1);
  first = larger<I>(first, 0);
  last = smaller<I>(last, brick_edge - 1);
  return first > last ? VoxelRange{1, 0} : VoxelRange{int(first), int(last)};
}

/// Returns the voxel of a brick, x + 8y + 64z, for cell u + 8v of slab w across `axis`.
GB_HD int voxel_of_cell(int axis, int slab, int cell) {
  const int bits_u = axis == 2 ? 0 : 3 * axis + 3, bits_v = axis == 0 ? 6 : 3 * axis - 3;
  return slab << 3 * axis | (cell & 7) << bits_u | (cell >> 3) << bits_v;
}

/// Edge functions of a triangle projected along one axis, evaluated for cell (0,0), with their steps per cell. A cell
/// passes the test if all three values are ≥ 0.
template <class I>
struct EdgeFunctions {
  I value[3], step_a[3], step_b[3];
};

enum class CellTest : std::uint8_t { open_overlap, closed_overlap, centre_inside };

/// Sets up the edge functions. `a` and `b` are the projection axes in cyclic order; `normal` is the normal's component
/// along the third axis. Degenerate projections (normal = 0) are also correct: their collinear edges point both ways,
/// so the test is two-sided.
template <class I>
GB_HD EdgeFunctions<I> edge_functions(const BrickTriangle<I>& t, int a, int b, I normal, CellTest test) {
  EdgeFunctions<I> r;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    I ea = -(t.p[j][b] - t.p[i][b]), eb = t.p[j][a] - t.p[i][a];
    if (normal < 0) ea = -ea, eb = -eb;
    I value = -(ea * t.p[i][a] + eb * t.p[i][b]);
    if (test == CellTest::centre_inside)
      value += (ea + eb) * I(subvoxels / 2);
    else
      value += (larger<I>(ea, 0) + larger<I>(eb, 0)) * I(subvoxels);  // the cell's innermost corner
    // For integers, > 0 means ≥ 1. An edge that projects to a point excludes no cell.
    if (test == CellTest::open_overlap && (ea != 0 || eb != 0)) value -= 1;
    r.value[i] = value;
    r.step_a[i] = ea * I(subvoxels);
    r.step_b[i] = eb * I(subvoxels);
  }
  return r;
}

/// Returns a mask in which bit a + 8b is set for each cell (a, b) of the ranges that passes the test.
template <class I>
GB_HD std::uint64_t passing_cells(const EdgeFunctions<I>& e, VoxelRange ra, VoxelRange rb) {
  std::uint64_t mask = 0;
  for (int b = rb.first; b <= rb.last; ++b) {
    I v0 = e.value[0] + e.step_a[0] * ra.first + e.step_b[0] * b;
    I v1 = e.value[1] + e.step_a[1] * ra.first + e.step_b[1] * b;
    I v2 = e.value[2] + e.step_a[2] * ra.first + e.step_b[2] * b;
    std::uint64_t bit = std::uint64_t(1) << (ra.first + 8 * b);
    for (int a = ra.first; a <= ra.last; ++a) {
      if ((v0 | v1 | v2) >= 0) mask |= bit;  // none of the three has its sign bit set
      v0 += e.step_a[0];
      v1 += e.step_a[1];
      v2 += e.step_a[2];
      bit <<= 1;
    }
  }
  return mask;
}

/// Returns row k of an 8×8 mask, repeated in all eight rows.
GB_HD std::uint64_t repeat_row(std::uint64_t mask, int k) { return ((mask >> (8 * k)) & 255) * 0x0101010101010101ull; }

/// Returns a mask whose row j consists of copies of bit j of row k of an 8×8 mask.
GB_HD std::uint64_t spread_row(std::uint64_t mask, int k) {
  const std::uint64_t picked = repeat_row(mask, k) & 0x8040201008040201ull;
  return (((picked + 0x7f7f7f7f7f7f7f7full) >> 7) & 0x0101010101010101ull) * 255;
}

/// Removes the cells of slab w whose cube does not intersect the triangle's plane.
template <class I>
GB_HD std::uint64_t cut_by_plane(const BrickTriangle<I>& t, std::uint64_t cells, int w, bool closed) {
  using P = typename PlaneInteger<I>::type;
  const P nu = P(t.n[0]) * subvoxels, nv = P(t.n[1]) * subvoxels, nw = P(t.n[2]) * subvoxels;
  const P at_corner = nw * w - (P(t.n[0]) * P(t.p[0][0]) + P(t.n[1]) * P(t.p[0][1]) + P(t.n[2]) * P(t.p[0][2]));
  const P slack = closed ? 0 : 1;  // open: 0 lies strictly between the min and max over the cube
  // A cell passes if the plane value at its lowest corner lies in [minimum, maximum].
  const P maximum = -(at_corner + smaller<P>(nu, 0) + smaller<P>(nv, 0) + smaller<P>(nw, 0) + slack);
  const P minimum = -(at_corner + larger<P>(nu, 0) + larger<P>(nv, 0) + larger<P>(nw, 0) - slack);
  std::uint64_t kept = 0;
  for (std::uint64_t rest = cells; rest != 0; rest &= rest - 1) {
#if defined(__CUDA_ARCH__)
    const int cell = __ffsll(static_cast<long long>(rest)) - 1;
#else
    const int cell = __builtin_ctzll(rest);
#endif
    // If I has 32 bits, a device computes each product with its 64-bit result in one instruction.
    const P value = P(t.n[0]) * P(I((cell & 7) << subvoxel_bits)) + P(t.n[1]) * P(I((cell >> 3) << subvoxel_bits));
    if (value >= minimum && value <= maximum) kept |= rest & (~rest + 1);
  }
  return kept;
}

/// Sets bit u + 8v of slab[w] for each voxel whose open (area) or closed (conservative) cube overlaps the triangle.
template <class I, class Slabs>
GB_HD void overlapped_voxels(const BrickTriangle<I>& t, bool closed, Slabs slab) {
  for (int w = 0; w < 8; ++w) slab[w] = 0;
  const VoxelRange ru = extent_voxels(t, 0, closed), rv = extent_voxels(t, 1, closed), rw = extent_voxels(t, 2, closed);
  if (ru.first > ru.last || rv.first > rv.last || rw.first > rw.last) return;
  const CellTest test = closed ? CellTest::closed_overlap : CellTest::open_overlap;
  const std::uint64_t uv = passing_cells(edge_functions(t, 0, 1, t.n[2], test), ru, rv);
  if (t.n[0] == 0 && t.n[1] == 0) {  // the triangle lies in a plane w = const: one slab, or two at closed contact
    for (int w = rw.first; w <= rw.last; ++w) slab[w] = uv;
    return;
  }
  const std::uint64_t vw = passing_cells(edge_functions(t, 1, 2, t.n[0], test), rv, rw);
  const std::uint64_t wu = passing_cells(edge_functions(t, 2, 0, t.n[1], test), rw, ru);
  // Cell (w, u) is bit w + 8u of `wu`. Its column w is transposed into the low eight bits, one per u.
  for (int w = rw.first; w <= rw.last; ++w) {
    std::uint64_t over_u = (wu >> w) & 0x0101010101010101ull;
    over_u = (over_u * 0x0102040810204080ull) >> 56;
    const std::uint64_t cells = uv & spread_row(vw, w) & (over_u * 0x0101010101010101ull);
    if (cells != 0) slab[w] = cut_by_plane(t, cells, w, closed);
  }
}

/// Calls set(i, j, k) for each voxel whose centre line along axis c crosses the triangle within the voxel's half-open
/// length. The voxel has index i along axis a, j along b and k along c; a and b follow c cyclically. SurfaceRule::thin
/// is the union over the three axes c.
template <class I, class Set>
GB_HD void crossed_along(const BrickTriangle<I>& t, int c, Set&& set) {
  if (t.n[c] == 0) return;  // The triangle is parallel to axis c; calls for the other axes find its voxels.
  const int a = (c + 1) % 3, b = (c + 2) % 3;
  const VoxelRange ra = extent_voxels(t, a, true), rb = extent_voxels(t, b, true), rc = extent_voxels(t, c, true);
  const std::uint64_t inside = passing_cells(edge_functions(t, a, b, t.n[c], CellTest::centre_inside), ra, rb);
  using P = typename PlaneInteger<I>::type;
  const P sign = t.n[c] < 0 ? -1 : 1;
  for (int j = rb.first; j <= rb.last; ++j)
    for (int i = ra.first; i <= ra.last; ++i) {
      if ((inside >> (i + 8 * j) & 1) == 0) continue;
      for (int k = rc.first; k <= rc.last; ++k) {
        const P bottom =
            sign * (P(t.n[a]) * (subvoxels * i + subvoxels / 2 - t.p[0][a]) +
                    P(t.n[b]) * (subvoxels * j + subvoxels / 2 - t.p[0][b]) + P(t.n[c]) * (subvoxels * k - t.p[0][c]));
        if (bottom <= 0 && bottom + sign * P(t.n[c]) * subvoxels > 0) set(i, j, k);
      }
    }
}

template <class I, class Slabs>
GB_HD void thin_voxels(const BrickTriangle<I>& t, Slabs slab) {
  for (int w = 0; w < 8; ++w) slab[w] = 0;
  crossed_along(t, 2, [&](int u, int v, int w) { slab[w] |= std::uint64_t(1) << (u + 8 * v); });
  crossed_along(t, 0, [&](int v, int w, int u) { slab[w] |= std::uint64_t(1) << (u + 8 * v); });
  crossed_along(t, 1, [&](int w, int u, int v) { slab[w] |= std::uint64_t(1) << (u + 8 * v); });
}

/// Sets bit u + 8v of slab[w] for each voxel of the brick that the triangle occupies under the rule. Slabs is
/// std::uint64_t* or any type with operator[].
template <class I, class Slabs>
GB_HD void touched_voxels(const BrickTriangle<I>& t, SurfaceRule rule, Slabs slab) {
  if (rule == SurfaceRule::thin)
    thin_voxels(t, slab);
  else
    overlapped_voxels(t, rule == SurfaceRule::conservative, slab);
}

}  // namespace gigabake::kernels
