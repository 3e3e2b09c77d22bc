/// Triangles that reach too far for exact arithmetic. A vertex with a wrong unit makes them; they are left out,
/// wherever cells are cut, and a survey counts them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "format/job/survey.h"
#include "format/source/mesh.h"
#include "kernels/body/brick_triangle.h"
#include "lattice/parameters.h"
#include "worker/column_span.h"
#include "worker/instance_bounds.h"

namespace gigabake {

/// In sub-voxels: then the vertices of a triangle are within kernels::widest_coordinate of the lowest corner of every
/// cell that it meets.
inline constexpr std::int64_t longest_side = longest_side_voxels * subvoxels;
static_assert(longest_side + 8192 * subvoxels == kernels::widest_coordinate);  // the largest cell

/// Longest side of its box, sub-voxels.
inline std::int64_t side_of(const LatticeTriangle& t) {
  std::int64_t side = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t low = std::min({t.p[0][axis], t.p[1][axis], t.p[2][axis]});
    const std::int64_t high = std::max({t.p[0][axis], t.p[1][axis], t.p[2][axis]});
    side = std::max(side, high - low);
  }
  return side;
}

/// False only where no triangle inside the box reaches too far.
bool may_reach_too_far(const SceneBox& box, const BakeParameters& parameters);

/// The primitive's index list without the triangles that, so placed, reach too far; others keep their order.
std::vector<std::uint32_t> index_without_far(const Primitive& primitive, const Instance& instance,
                                             const BakeParameters& parameters);

}  // namespace gigabake
