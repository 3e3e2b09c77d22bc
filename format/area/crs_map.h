/// Conversion from positions on the earth to the coordinates of a coordinate system.
#pragma once

#include <array>
#include <span>

namespace gigabake {

/// A map to a coordinate system. Thread-safe.
class CrsMap {
 public:
  virtual ~CrsMap() = default;
  /// Converts longitude and latitude in degrees and the height above the WGS84 ellipsoid in metres, in place. The
  /// result is x (east), y (north) and the height. Coordinates of a point without an image become NaN.
  virtual void convert(std::span<std::array<double, 3>> points) const = 0;
  /// Returns whether the coordinates x, y and height have a place on the earth, and convert() returns them again for
  /// this place.
  virtual bool has_place(const std::array<double, 3>& coordinates) const = 0;
};

}  // namespace gigabake
