/// Conversion between positions on the earth and the coordinates of a coordinate system.
#pragma once

#include <array>
#include <span>
#include <string>

namespace gigabake {

/// The properties of a coordinate system that files of maps and points state.
struct CrsFacts {
  std::string wkt;                ///< WKT 1; WKT 2 if WKT 1 cannot express the system
  bool is_in_degrees = false;     ///< x and y are longitude and latitude
  bool is_wgs84_degrees = false;  ///< EPSG:4326: x and y are the degrees of convert() themselves
  double metres_per_unit = 0;     ///< of x and y; 0 if they are degrees
  bool has_heights = false;       ///< the system has a vertical part; else heights are above the WGS84 ellipsoid
  std::string height_unit = "m";
};

/// A map to a coordinate system. Thread-safe.
class CrsMap {
 public:
  virtual ~CrsMap() = default;
  /// Converts longitude and latitude in degrees and the height above the WGS84 ellipsoid in metres, in place. The
  /// result is x (east), y (north) and the height. Coordinates of a point without an image become NaN.
  virtual void convert(std::span<std::array<double, 3>> points) const = 0;
  /// Converts x, y and the height of the system to longitude, latitude and the height above the ellipsoid, in place.
  /// Coordinates without a place become NaN.
  virtual void to_degrees(std::span<std::array<double, 3>> points) const = 0;
  virtual const CrsFacts& facts() const = 0;
  /// Returns whether the coordinates x, y and height have a place on the earth, and convert() returns them again for
  /// this place.
  virtual bool has_place(const std::array<double, 3>& coordinates) const = 0;
};

}  // namespace gigabake
