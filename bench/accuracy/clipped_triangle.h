/// Clips triangles to cubes and measures their distance from points. Uses plain double arithmetic. It shares no
/// code with the baker except Vec3, so that it is an independent reference.
#pragma once

#include <array>
#include <vector>

#include "core/math/vec3.h"

namespace gigabake::bench {

using Corners = std::array<Vec3d, 3>;

/// A corner of a clipped polygon, and its barycentric weights for the triangle's second and third vertex.
struct ClippedCorner {
  Vec3d at{};
  double second = 0, third = 0;
};

/// Returns the part of the triangle in the closed cube [lowest, lowest + edge]: a convex polygon, or nothing.
/// Source  Sutherland and Hodgman 1974.
std::vector<ClippedCorner> clip_to_cube(const Corners& triangle, const Vec3d& lowest, double edge);

double area_of(const std::vector<ClippedCorner>& polygon);

/// Returns a point of the polygon, distributed uniformly over its area if u and v are uniform in [0, 1).
/// Range   The area is above 0.
ClippedCorner point_in(const std::vector<ClippedCorner>& polygon, double u, double v);

/// Returns the distance from p to the nearest point of the closed triangle.
/// Range   The area is above 0.
/// Source  Ericson 2005, 5.1.5.
double distance_to(const Corners& triangle, const Vec3d& p);

/// Returns the right-handed normal; its length is twice the area.
Vec3d normal_of(const Corners& triangle);

}  // namespace gigabake::bench
