/// Coordinates of an area as integers, so that tests of its border are exact.
///
/// Exact   A coordinate is rounded once. All tests of sides and crossings then use integers without overflow.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace gigabake {

/// The number of units per degree or metre: 2^-30 degrees are 0.1 mm on the earth.
inline constexpr double fixed_per_unit = 1073741824.0;
/// The max absolute coordinate, in degrees or metres. It is larger than the coordinates of any projection of the earth.
inline constexpr double max_area_coordinate = 1e9;
inline constexpr double full_turn_degrees = 360, max_latitude_degrees = 90;

/// A position in an area's coordinates: x to the east, y to the north.
struct FixedPoint {
  std::int64_t x = 0, y = 0;
  friend bool operator==(const FixedPoint&, const FixedPoint&) = default;
  friend auto operator<=>(const FixedPoint&, const FixedPoint&) = default;
};

/// Returns the nearest integer coordinate. Clamps a value beyond the max coordinate.
/// Range   `value` is not NaN.
inline std::int64_t to_fixed(double value) {
  return std::int64_t(std::floor(std::clamp(value, -max_area_coordinate, max_area_coordinate) * fixed_per_unit + 0.5));
}

/// A closed box in an area's coordinates.
struct FixedBox {
  FixedPoint low, high;
};

/// Returns 1 if `p` is on the left of the line from `a` to `b`, -1 on the right, and 0 on the line.
inline int side_of(const FixedPoint& a, const FixedPoint& b, const FixedPoint& p) {
  using Wide = __int128;
  const Wide left = Wide(b.x - a.x) * (p.y - a.y), right = Wide(b.y - a.y) * (p.x - a.x);
  return left > right ? 1 : left < right ? -1 : 0;
}

}  // namespace gigabake
