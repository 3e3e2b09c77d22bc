/// What of a triangle lies in a cube, and how far it is from a point: in double, by the plainest methods, and nothing
/// of the baker's.
#pragma once

#include <array>
#include <vector>

namespace gigabake::bench {

using Vector = std::array<double, 3>;
using Corners = std::array<Vector, 3>;

/// A corner of what is left, with the triangle's barycentric weights of its second and third vertex.
struct ClippedCorner {
  Vector at{};
  double second = 0, third = 0;
};

/// The triangle inside the closed cube [lowest, lowest + edge]: a convex polygon, or nothing.
/// Source  Sutherland and Hodgman 1974.
std::vector<ClippedCorner> clip_to_cube(const Corners& triangle, const Vector& lowest, double edge);

double area_of(const std::vector<ClippedCorner>& polygon);

/// A point of the polygon, uniform in its area for u, v uniform in [0, 1). Range  an area above 0.
ClippedCorner point_in(const std::vector<ClippedCorner>& polygon, double u, double v);

/// From p to the nearest point of the closed triangle. Range  an area above 0. Source  Ericson 2005, 5.1.5.
double distance_to(const Corners& triangle, const Vector& p);

/// Twice the area long, by the right hand.
Vector normal_of(const Corners& triangle);

inline Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace gigabake::bench
