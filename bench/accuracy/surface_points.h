/// Points of a source's surface, spread evenly over its area.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "worker/source_triangles.h"

namespace gigabake::bench {

/// One point at random in each of `most` equal shares of the area, in the order of the triangles; of these the ones
/// where the source's alpha is above 0. In voxels of the lattice.
std::vector<std::array<double, 3>> surface_points(const SourceTriangles& source, std::uint64_t most,
                                                  std::uint64_t seed);

}  // namespace gigabake::bench
