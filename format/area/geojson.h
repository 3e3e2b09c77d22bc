/// Polygons and lines of a GeoJSON file.
#pragma once

#include <filesystem>
#include <vector>

#include "core/math/frames.h"
#include "format/area/polygon.h"

namespace gigabake {

/// Reads the polygons of a GeoJSON file (RFC 7946): longitude and latitude in degrees. Reads Polygon and MultiPolygon,
/// also in Feature, FeatureCollection and GeometryCollection. Heights of positions are ignored.
/// An edge over more than 180 degrees of longitude crosses the antimeridian, unless it spans all 360 degrees.
/// Longitudes of a ring are continuous in the result; they may exceed 180 degrees.
/// Errors  InputError(file, key): the file is not GeoJSON, has no polygon or another geometry, or states another
///         coordinate system. A ring is not closed, has fewer than four positions, encloses a pole, or crosses itself
///         or another ring of its polygon. A hole lies outside.
std::vector<AreaPolygon> read_geojson_polygons(const std::filesystem::path& file);

/// Reads the only LineString of a GeoJSON file (RFC 7946), which may be in a Feature, FeatureCollection or
/// GeometryCollection. Returns its positions without heights; no two adjacent positions are equal.
/// Errors  InputError(file, key): the file is not GeoJSON, has no line, several lines or another geometry, or states
///         another coordinate system. The line has fewer than two different positions.
std::vector<Geodetic> read_geojson_line(const std::filesystem::path& file);

}  // namespace gigabake
