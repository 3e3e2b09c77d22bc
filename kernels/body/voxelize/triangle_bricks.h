/// Search for the bricks of a window that a triangle may touch. The bricks of a small triangle are all bricks of its
/// bounding box. For a large triangle, the search descends the octree with an exact closed triangle-cube test. The cost
/// of a long sliver then grows with its length and not with the volume of its box.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/base/rules.h"
#include "core/math/box3.h"
#include "core/math/vec3.h"
#include "core/octree/morton.h"
#include "kernels/body/voxelize/brick_triangle.h"
#include "kernels/body/voxelize/window.h"

namespace gigabake::kernels {

inline constexpr int brick_subvoxel_bits = 11;  ///< 8 voxels · 256
/// Max number of bricks in a triangle's box for direct enumeration. If a box has more bricks, the search descends the
/// octree.
inline constexpr int max_direct_bricks = 8;

/// Returns a brick's lowest corner, in window sub-voxels.
GB_HD Vec3<std::int32_t> brick_corner(std::uint64_t key) {
  return static_cast<Vec3<std::int32_t>>(demorton(key)) << brick_subvoxel_bits;
}

/// A box of bricks, in bricks from the window's lowest corner.
using BrickBox = Box3<std::int32_t>;

/// Computes the bricks of the triangle's bounding box inside the window. Returns false if there are none.
GB_HD bool brick_box(const WindowTriangle& t, SurfaceRule rule, std::int32_t window_bricks, BrickBox& box) {
  for (int c = 0; c < 3; ++c) {
    const std::int32_t lo = smaller(smaller(t.p[0][c], t.p[1][c]), t.p[2][c]);
    const std::int32_t hi = larger(larger(t.p[0][c], t.p[1][c]), t.p[2][c]);
    const bool closed = rule != SurfaceRule::area;
    box.min[c] = larger((closed ? lo - 1 : lo) >> brick_subvoxel_bits, 0);
    box.end[c] = smaller((closed || hi == lo ? hi : hi - 1) >> brick_subvoxel_bits, window_bricks - 1) + 1;
    if (box.min[c] >= box.end[c]) return false;
  }
  return true;
}

GB_HD std::int64_t brick_count(const BrickBox& box) {
  const Vec3<std::int32_t> size = box.size();
  return std::int64_t(size[0]) * size[1] * size[2];
}

/// Calls visit(key) for every brick of the box.
template <class Visit>
GB_HD void for_each_key(const BrickBox& box, const Visit& visit) {
  for (std::int32_t z = box.min[2]; z < box.end[2]; ++z)
    for (std::int32_t y = box.min[1]; y < box.end[1]; ++y)
      for (std::int32_t x = box.min[0]; x < box.end[0]; ++x)
        visit(morton(std::uint32_t(x), std::uint32_t(y), std::uint32_t(z)));
}

/// Returns true if the closed triangle intersects the closed cube [corner, corner+edge]³. Tests the plane and the nine
/// edge axes; the caller has already compared the boxes.
/// Source  Akenine-Möller 2001.
template <class I>
GB_HD bool intersects_cube(const WindowTriangle& t, const Vec3i64& corner, std::int64_t edge) {
  using V = Vec3<I>;
  V p[3];
  for (int i = 0; i < 3; ++i) p[i] = static_cast<V>(t.p[i]) - static_cast<V>(corner);
  const V n = cross(p[1] - p[0], p[2] - p[0]);
  const I plane = -dot(n, p[0]);
  I low = 0, high = 0;
  for (int c = 0; c < 3; ++c) {
    low += smaller<I>(n[c] * edge, 0);
    high += larger<I>(n[c] * edge, 0);
  }
  if (plane + low > 0 || plane + high < 0) return false;
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 3; ++i) {
      const int a = (c + 1) % 3, b = (c + 2) % 3, j = (i + 1) % 3;
      I ea = -(p[j][b] - p[i][b]), eb = p[j][a] - p[i][a];
      if (n[c] < 0) ea = -ea, eb = -eb;
      if ((larger<I>(ea, 0) + larger<I>(eb, 0)) * edge - (ea * p[i][a] + eb * p[i][b]) < 0) return false;
    }
  return true;
}

GB_HD bool is_within_extent(const WindowTriangle& t, std::int64_t extent) {
  for (int c = 0; c < 3; ++c) {
    const std::int64_t lo = smaller(smaller(t.p[0][c], t.p[1][c]), t.p[2][c]);
    const std::int64_t hi = larger(larger(t.p[0][c], t.p[1][c]), t.p[2][c]);
    if (hi - lo > extent) return false;
  }
  return true;
}

GB_HD bool is_narrow(const WindowTriangle& t) { return is_within_extent(t, narrow_extent); }
GB_HD bool is_small(const WindowTriangle& t) { return is_within_extent(t, small_extent); }

/// Calls visit(I()) with the narrowest integer type I in which the triangle's arithmetic cannot overflow.
template <class Visit>
GB_HD auto with_integer_for(const WindowTriangle& t, const Visit& visit) {
  if (is_small(t)) return visit(std::int32_t());
  return is_narrow(t) ? visit(std::int64_t()) : visit(__int128());
}

/// Returns true if the triangle may touch an octree node of 2^level bricks per axis. `box` is the triangle's
/// brick_box(). If `narrow`, 64-bit integers suffice for the test.
GB_HD bool may_touch_node(const WindowTriangle& t, const BrickBox& box, bool narrow, const Vec3<std::int32_t>& node,
                          int level) {
  const std::int64_t edge = std::int64_t(1) << (brick_subvoxel_bits + level);
  if (!box.overlaps({node << level, (node + Vec3<std::int32_t>::all(1)) << level})) return false;
  const Vec3i64 corner = static_cast<Vec3i64>(node) * edge;
  return narrow ? intersects_cube<std::int64_t>(t, corner, edge) : intersects_cube<__int128>(t, corner, edge);
}

/// Calls visit(key) for the bricks below an octree node that the triangle may touch. Level 0 is a brick.
template <class Visit>
void descend(const WindowTriangle& t, const BrickBox& box, bool narrow, const Vec3<std::int32_t>& node, int level,
             const Visit& visit) {
  if (!may_touch_node(t, box, narrow, node, level)) return;
  if (level == 0) {
    visit(morton(std::uint32_t(node[0]), std::uint32_t(node[1]), std::uint32_t(node[2])));
    return;
  }
  for (int child = 0; child < 8; ++child)
    descend(t, box, narrow, node * 2 + Vec3<std::int32_t>{child & 1, child >> 1 & 1, child >> 2}, level - 1, visit);
}

/// Calls visit(key) for every brick of the window that the triangle may touch.
template <class Visit>
void for_each_brick(const WindowTriangle& t, const CellWindow& window, const Visit& visit) {
  BrickBox box;
  if (!brick_box(t, window.rule, window.bricks, box)) return;
  if (brick_count(box) <= max_direct_bricks) return for_each_key(box, visit);
  descend(t, box, is_narrow(t), Vec3<std::int32_t>::all(0), window.levels, visit);
}

}  // namespace gigabake::kernels
