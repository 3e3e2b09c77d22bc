/// Triangulation of polygons in space.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gigabake {

/// The max number of corners of a polygon. The triangles of a polygon fit into one part (max_part_triangles).
inline constexpr std::size_t max_polygon_corners = std::size_t(1) << 20;

/// Returns the n - 2 triangles of a polygon of n corners, as three indices of corners per triangle. The triangles have
/// the orientation of the polygon. They form a fan if all triangles from the first corner have this orientation. Else
/// ears are clipped in the projection along the dominant axis of the mean normal (Newell's method).
/// Cost    O(n log n) (ear_clipper.h).
std::vector<std::uint32_t> triangles_of_polygon(std::span<const std::array<double, 3>> corners);

}  // namespace gigabake
