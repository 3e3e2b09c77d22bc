/// Classification of a triangle after its vertices are snapped: it is kept, or dropped for a reason.
///
/// Space   Sub-voxels from the window's lowest corner.
/// Exact   Integers after the snap: host and device return the same answer.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/vec3.h"
#include "kernels/body/cell.h"
#include "kernels/body/voxelize/brick_triangle.h"
#include "kernels/body/voxelize/part.h"
#include "kernels/body/voxelize/window.h"

namespace gigabake::kernels {

/// Snapped vertex. Its first component holds a special value if the vertex could not be snapped.
using SnappedVertex = Vec3<std::int32_t>;
inline constexpr std::int32_t not_finite = INT32_MIN;        ///< NaN, infinite or off the lattice
inline constexpr std::int32_t out_of_reach = INT32_MIN + 1;  ///< beyond max_coordinate

enum class TriangleClass : std::uint8_t {
  elsewhere,   ///< does not touch the window
  kept,        ///< may touch the window
  non_finite,  ///< dropped: a vertex is NaN/Inf or off the lattice
  zero_area,   ///< dropped: no area after the snap
  oversized    ///< extends farther from the window than max_coordinate; the cell must fail
};
inline constexpr int triangle_classes = 5;

/// Number of triangles per class. `bad_uv` counts the kept triangles with unusable texture coordinates.
template <class Count>
struct TriangleCounts {
  Count triangle_class[triangle_classes];
  Count bad_uv;
};

template <class Count>
void add_to(CellStats& stats, const TriangleCounts<Count>& counts) {
  stats.triangles += counts.triangle_class[int(TriangleClass::kept)];
  stats.non_finite += counts.triangle_class[int(TriangleClass::non_finite)];
  stats.zero_area += counts.triangle_class[int(TriangleClass::zero_area)];
  stats.oversized += counts.triangle_class[int(TriangleClass::oversized)];
  stats.bad_uv += counts.bad_uv;
}

/// Snaps a vertex of a part whose triangles are voxelized at level `lod`.
GB_HD SnappedVertex snap_vertex(const SnapWindow& window, const PartArrays& part, std::uint32_t vertex, int lod = 0) {
  LatticePoint p;
  if (!snap_to_level(window.frame, part.scene_from_local, part.position + 3 * std::size_t(vertex), lod, p))
    return {not_finite, 0, 0};
  const Vec3i64 at = p.v - window.min * subvoxels;
  bool is_far = false;
  for (const std::int64_t x : at) is_far |= x > max_coordinate || x < -max_coordinate;
  auto s = static_cast<SnappedVertex>(at);
  if (is_far) s[0] = out_of_reach;
  return s;
}

/// Returns true if the triangle has area. Wide is an integer type that holds the product of two differences of
/// coordinates.
template <class Wide, class T>
GB_HD bool has_area(const Vec3<T> p[3]) {
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Wide bi = Wide(p[1][i]) - p[0][i], bj = Wide(p[1][j]) - p[0][j];
    const Wide ci = Wide(p[2][i]) - p[0][i], cj = Wide(p[2][j]) - p[0][j];
    if (bi * cj != bj * ci) return true;
  }
  return false;
}

/// Returns true if the triangle's bounding box intersects the closed window, whose edge has `edge` sub-voxels. Other
/// triangles occupy no voxel of the window under any surface rule.
template <class T>
GB_HD bool intersects_window(const Vec3<T> p[3], std::int64_t edge) {
  for (int c = 0; c < 3; ++c) {
    const std::int64_t a = p[0][c], b = p[1][c], d = p[2][c];
    if (smaller(smaller(a, b), d) > edge || larger(larger(a, b), d) < 0) return false;
  }
  return true;
}

/// Classifies a triangle with a vertex beyond max_coordinate. Its vertices are snapped again, into wider integers.
GB_HD TriangleClass classify_far_triangle(const CellWindow& window, const PartArrays& part, const std::uint32_t v[3],
                                          int lod) {
  Vec3i64 p[3];
  for (int i = 0; i < 3; ++i) {
    LatticePoint vertex{};
    snap_to_level(window.frame, part.scene_from_local, part.position + 3 * std::size_t(v[i]), lod, vertex);
    p[i] = vertex.v - window.min * subvoxels;
  }
  if (!intersects_window(p, window.edge)) return TriangleClass::elsewhere;
  return has_area<__int128>(p) ? TriangleClass::oversized : TriangleClass::zero_area;
}

/// Classifies a triangle. `v` holds the indices of its vertices, and `p` the results of snap_vertex() for them, with
/// the same level.
GB_HD TriangleClass classify_triangle(const CellWindow& window, const PartArrays& part, const std::uint32_t v[3],
                                      const SnappedVertex p[3], int lod = 0) {
  bool is_far = false;
  for (int i = 0; i < 3; ++i) {
    if (p[i][0] == not_finite) return TriangleClass::non_finite;
    is_far |= p[i][0] == out_of_reach;
  }
  if (is_far) return classify_far_triangle(window, part, v, lod);
  if (!intersects_window(p, window.edge)) return TriangleClass::elsewhere;
  return has_area<std::int64_t>(p) ? TriangleClass::kept : TriangleClass::zero_area;
}

GB_HD bool has_bad_uv(TriangleClass triangle_class, const PartArrays& part, const std::uint32_t v[3]) {
  float uv[6];
  if (triangle_class != TriangleClass::kept) return false;
  return (part.textured && !load_uv(part.uv, v, uv)) ||
         (part.normal_map.texture >= 0 && !load_uv(part.normal_uv, v, uv));
}

}  // namespace gigabake::kernels
