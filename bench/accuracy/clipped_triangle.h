/// Clips triangles to cubes and measures their distance from points. Uses plain double arithmetic and shares no code
/// with the baker, so that it is an independent reference.
#pragma once

#include <array>
#include <vector>

namespace gigabake::bench {

using Vector = std::array<double, 3>;
using Corners = std::array<Vector, 3>;

/// A corner of a clipped polygon, and its barycentric weights for the triangle's second and third vertex.
struct ClippedCorner {
  Vector at{};
  double second = 0, third = 0;
};

/// Returns the part of the triangle in the closed cube [lowest, lowest + edge]: a convex polygon, or nothing.
/// Source  Sutherland and Hodgman 1974.
std::vector<ClippedCorner> clip_to_cube(const Corners& triangle, const Vector& lowest, double edge);

double area_of(const std::vector<ClippedCorner>& polygon);

/// Returns a point of the polygon, distributed uniformly over its area if u and v are uniform in [0, 1).
/// Range   The area is above 0.
ClippedCorner point_in(const std::vector<ClippedCorner>& polygon, double u, double v);

/// Returns the distance from p to the nearest point of the closed triangle.
/// Range   The area is above 0.
/// Source  Ericson 2005, 5.1.5.
double distance_to(const Corners& triangle, const Vector& p);

/// Returns the right-handed normal; its length is twice the area.
Vector normal_of(const Corners& triangle);

inline Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace gigabake::bench
