/// An area of interest: the part of a scene that a command uses.
///
/// Exact   Intervals are half-open: a position on the western, southern or lower bound is inside; a position on the
///         eastern, northern or upper bound is outside. Polygons follow the same rule (polygon.h).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/rules.h"
#include "core/io/bytes.h"
#include "format/area/crs_map.h"
#include "format/area/polygon.h"

namespace gigabake {

/// The coordinates in which bounds are given.
enum class AreaFrame : std::uint8_t {
  degrees,  ///< longitude and latitude, and metres above the WGS84 ellipsoid
  crs,      ///< coordinates of a coordinate system
  scene     ///< metres of the scene's frame
};
template <>
constexpr auto names_of<AreaFrame>() {
  return std::to_array<std::string_view>({"degrees", "crs", "scene"});
}

/// A half-open box. In degrees, `high.x` may exceed 180: the box then crosses the antimeridian.
struct AreaBounds {
  AreaFrame frame = AreaFrame::degrees;
  FixedPoint low, high;  ///< west and south, east and north
  double height_low_m = -std::numeric_limits<double>::infinity();
  double height_high_m = std::numeric_limits<double>::infinity();
};

/// An area of interest. A position is inside if it is within the bounds, if there are bounds, and in one of the
/// polygons, if there are polygons. Polygons have degrees.
struct Area {
  std::optional<AreaBounds> bounds;
  std::vector<AreaPolygon> polygons;
  std::string crs;                                  ///< the coordinate system of bounds in AreaFrame::crs
  std::shared_ptr<const CrsMap> crs_map = nullptr;  ///< the map of `crs`; null for other frames
};

/// Returns the bounds W,S,E,N or W,S,E,N,LOW,HIGH.
/// Errors  UsageError: the bounds are empty or swapped, or degrees are out of range. `option` is the option's name.
AreaBounds bounds_of_numbers(const char* option, const std::vector<double>& numbers, AreaFrame frame);

/// Returns whether the area refers to places on the earth. Otherwise it refers to the frame of a scene.
bool is_on_earth(const Area& area);

/// Serializes all fields except crs_map.
void put(ByteWriter& writer, const Area& area);
/// Reads the fields that put() wrote.
/// Errors  InputError if the bytes are malformed.
Area get_area(ByteReader& reader);

}  // namespace gigabake
