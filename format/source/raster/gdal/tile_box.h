/// Boxes around the tiles of rasters.
#pragma once

#include <vector>

#include "format/source/raster/dem.h"
#include "format/source/raster/ground.h"

namespace gigabake {

/// Sets DemTile::low_m and high_m from sample points of the tile, which are results of Ground::locate(). Adds a margin
/// for the surface between the points.
void set_box(const Ground::Frame& frame, const std::vector<double>& x, const std::vector<double>& y, DemTile& tile);

}  // namespace gigabake
