#include "format/source/mesh/polygon.h"

#include <algorithm>
#include <cmath>

#include "format/source/mesh/ear_clipper.h"

namespace gigabake {
namespace {

/// Projects the polygon along the dominant axis of its normal. The result is counter-clockwise and relative to the
/// first corner.
std::vector<PlaneCorner> flattened(std::span<const std::array<double, 3>> corners) {
  std::array<double, 3> normal{};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto &a = corners[i], &b = corners[(i + 1) % corners.size()];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t u = (c + 1) % 3, v = (c + 2) % 3;
      normal[c] += (a[u] - b[u]) * (a[v] + b[v] - 2 * corners[0][v]);
    }
  }
  std::size_t axis = 0;
  for (std::size_t c = 1; c < 3; ++c)
    if (std::fabs(normal[c]) > std::fabs(normal[axis])) axis = c;
  std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (normal[axis] < 0) std::swap(u, v);
  std::vector<PlaneCorner> flat;
  for (const auto& p : corners) flat.push_back({p[u] - corners[0][u], p[v] - corners[0][v]});
  return flat;
}

/// Returns whether all triangles of the fan from the first corner are counter-clockwise and thus do not overlap.
bool is_fan(const std::vector<PlaneCorner>& flat) {
  for (std::size_t i = 1; i + 1 < flat.size(); ++i)
    if (turn(flat[0], flat[i], flat[i + 1]) < 0) return false;
  return true;
}

/// Returns the distance below which corners count as collinear. Decimal coordinates are rounded to doubles, so corners
/// of a straight edge do not lie exactly on a line.
double rounding_error(std::span<const std::array<double, 3>> corners) {
  double max_magnitude = 0;
  for (const auto& p : corners)
    max_magnitude = std::max({max_magnitude, std::fabs(p[0]), std::fabs(p[1]), std::fabs(p[2])});
  return std::ldexp(max_magnitude, -46);
}

}  // namespace

std::vector<std::uint32_t> triangles_of_polygon(std::span<const std::array<double, 3>> corners) {
  if (corners.size() > 3) {
    const std::vector<PlaneCorner> flat = flattened(corners);
    if (!is_fan(flat)) return EarClipper(flat, rounding_error(corners)).triangles();
  }
  std::vector<std::uint32_t> fan;
  for (std::uint32_t i = 1; i + 1 < corners.size(); ++i) fan.insert(fan.end(), {0, i, i + 1});
  return fan;
}

}  // namespace gigabake
