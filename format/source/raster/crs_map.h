/// Coordinate systems by name, from PROJ.
#pragma once

#include <memory>
#include <string>

#include "format/area/crs_map.h"

namespace gigabake {

/// Returns the map to a coordinate system: "EPSG:25832", WKT or a PROJ text. x is the easting or longitude.
/// Exact   Never uses a ballpark transformation, which PROJ would choose if a grid were missing.
/// Errors  InputError: the text is unknown, names files, or is a local system. PROJ has no transformation, or misses
///         its grid. The build has no GDAL.
std::shared_ptr<const CrsMap> open_crs_map(const std::string& text);

}  // namespace gigabake
