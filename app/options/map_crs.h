/// The coordinate system of an export that is a map or a point cloud on the earth: the option --crs.
#pragma once

#include <string>

#include "app/options/area_options.h"
#include "query/maps/map_frame.h"

namespace gigabake::app {

/// Opens the coordinate system `crs`: EPSG:CODE, WKT, a PROJ text, or "scene"; if it is empty, default_map_crs().
/// Errors  UsageError: the coordinate system is unknown, or the scene has no place on the earth.
MapFrame open_map_frame(const SceneHeader& scene, const std::string& crs, int threads);

/// Returns the options without a coordinate system that concerns only the output, because there are no bounds.
AreaOptions area_without_map_crs(const AreaOptions& options);

}  // namespace gigabake::app
