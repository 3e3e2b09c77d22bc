#include "bench/accuracy/clipped_triangle.h"

#include <algorithm>
#include <cmath>

namespace gigabake::bench {
namespace {

ClippedCorner between(const ClippedCorner& a, const ClippedCorner& b, double t) {
  return {a.at + (b.at - a.at) * t, a.second + t * (b.second - a.second), a.third + t * (b.third - a.third)};
}

/// Returns the part of the polygon where sign·(coordinate - plane) ≥ 0.
std::vector<ClippedCorner> clip(const std::vector<ClippedCorner>& polygon, std::size_t axis, double plane,
                                double sign) {
  std::vector<ClippedCorner> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const ClippedCorner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double of_a = sign * (a.at[axis] - plane), of_b = sign * (b.at[axis] - plane);
    if (of_a >= 0) kept.push_back(a);
    if ((of_a < 0) != (of_b < 0)) kept.push_back(between(a, b, of_a / (of_a - of_b)));
  }
  return kept;
}

double fan_area(const std::vector<ClippedCorner>& polygon, std::size_t i) {
  return length(normal_of({polygon[0].at, polygon[i].at, polygon[i + 1].at})) / 2;
}

double distance_to_segment(const Vec3d& a, const Vec3d& b, const Vec3d& p) {
  const Vec3d ab = b - a, ap = p - a;
  const double t = std::clamp(dot(ap, ab) / dot(ab, ab), 0.0, 1.0);
  return length(ap - ab * t);
}

}  // namespace

Vec3d normal_of(const Corners& triangle) { return cross(triangle[1] - triangle[0], triangle[2] - triangle[0]); }

std::vector<ClippedCorner> clip_to_cube(const Corners& triangle, const Vec3d& lowest, double edge) {
  std::vector<ClippedCorner> polygon{{triangle[0], 0, 0}, {triangle[1], 1, 0}, {triangle[2], 0, 1}};
  for (std::size_t axis = 0; axis < 3 && !polygon.empty(); ++axis) {
    polygon = clip(polygon, axis, lowest[axis], 1);
    polygon = clip(polygon, axis, lowest[axis] + edge, -1);
  }
  return polygon;
}

double area_of(const std::vector<ClippedCorner>& polygon) {
  double area = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) area += fan_area(polygon, i);
  return area;
}

ClippedCorner point_in(const std::vector<ClippedCorner>& polygon, double u, double v) {
  double rest = u * area_of(polygon);
  std::size_t i = 1;
  for (; i + 2 < polygon.size() && rest >= fan_area(polygon, i); ++i) rest -= fan_area(polygon, i);
  // The remainder of u inside the chosen triangle is uniform again.
  const double w = std::sqrt(std::clamp(rest / fan_area(polygon, i), 0.0, 1.0));
  return between(polygon[0], between(polygon[i], polygon[i + 1], v), w);
}

double distance_to(const Corners& triangle, const Vec3d& p) {
  const Vec3d n = normal_of(triangle);
  bool inside = true;
  double nearest = INFINITY;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d &a = triangle[k], &b = triangle[(k + 1) % 3];
    inside = inside && dot(cross(n, b - a), p - a) >= 0;
    nearest = std::min(nearest, distance_to_segment(a, b, p));
  }
  return inside ? std::fabs(dot(n, p - triangle[0])) / length(n) : nearest;
}

}  // namespace gigabake::bench
