/// Points of a source's surface, distributed evenly over its area.
#pragma once

#include <cstdint>
#include <vector>

#include "core/math/vec3.h"
#include "worker/scan/source_triangles.h"

namespace gigabake::bench {

/// Returns one random point in each of `maximum` equal parts of the area, in the order of the triangles. Omits points
/// where the source's alpha is 0.
/// Space   Voxels of the lattice.
std::vector<Vec3d> surface_points(const SourceTriangles& source, std::uint64_t maximum, std::uint64_t seed);

}  // namespace gigabake::bench
