/// Polygons in space as triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gigabake {

/// Parts of meshes hold as many triangles (most_part_triangles).
inline constexpr std::size_t max_polygon_corners = std::size_t(1) << 20;

/// Returns indices of corners, three per triangle, n - 2 triangles that turn as the polygon does. One whose
/// first corner sees all others becomes a fan. Ears are cut off any other, seen along its mean normal (Newell's).
/// Cost  n log n (ear_clipper.h).
std::vector<std::uint32_t> triangles_of_polygon(std::span<const std::array<double, 3>> corners);

}  // namespace gigabake
