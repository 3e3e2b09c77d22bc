/// Maps to coordinate systems with the transformations of GDAL.
#pragma once

#include <memory>
#include <string>

#include "format/area/crs_map.h"

namespace gigabake {

/// Implements open_crs_map() of format/source/raster/crs_map.h.
std::shared_ptr<const CrsMap> gdal_crs_map(const std::string& text);

}  // namespace gigabake
