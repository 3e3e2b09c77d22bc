/// Polygons in space as triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gigabake {

/// Corners, three a triangle, all turning as the polygon does. A convex polygon is a fan from its first corner; another
/// of at most 512 corners loses ears, seen along its mean normal (Newell's); a larger one is a fan too.
/// Cost  corners, where it is convex; else at most their third power.
std::vector<std::uint32_t> triangles_of_polygon(std::span<const std::array<double, 3>> corners);

}  // namespace gigabake
