/// Triangles too long for exact arithmetic, typically because a vertex has a wrong unit. They are omitted independently
/// of the cell grid, and a scan counts them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/math/vec3.h"
#include "core/octree/parameters.h"
#include "format/job/tile_scan.h"
#include "format/source/mesh.h"
#include "kernels/body/voxelize/brick_triangle.h"
#include "worker/scan/column_span.h"
#include "worker/scan/instance_bounds.h"

namespace gigabake {

/// Max side of a triangle's box in sub-voxels. It keeps the vertices of a triangle within kernels::max_coordinate of
/// the lowest corner of every cell that the triangle overlaps.
inline constexpr std::int64_t max_triangle_side = max_side_voxels * subvoxels;
static_assert(max_triangle_side + 8192 * subvoxels == kernels::max_coordinate);  // edge of the largest cell

/// Returns the longest side of the triangle's box, in sub-voxels.
inline std::int64_t side_of(const LatticeTriangle& t) {
  const Vec3i64 low = min_by_axis(min_by_axis(t.p[0], t.p[1]), t.p[2]);
  const Vec3i64 high = max_by_axis(max_by_axis(t.p[0], t.p[1]), t.p[2]);
  return std::ranges::max(high - low);
}

/// Returns false only if no triangle inside the box can be too long.
bool may_have_long_triangle(const SceneBox& box, const BakeParameters& parameters);

/// Returns the primitive's index list without the triangles that are too long with this instance's transform; keeps the
/// order. `lod` is the level at which they are voxelized.
std::vector<std::uint32_t> index_without_long(const Primitive& primitive, const Instance& instance,
                                              const BakeParameters& parameters, int lod);

}  // namespace gigabake
