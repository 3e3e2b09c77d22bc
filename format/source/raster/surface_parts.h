/// Assignment of rasters to surfaces.
#pragma once

#include <vector>

#include "format/source/raster/gdal_raster.h"

namespace gigabake {

/// A raster before its assignment to a surface.
struct RasterHead {
  DemPart part;  ///< its position in the surface is set by group_surfaces()
  Grid grid;
  std::optional<OGRSpatialReference> crs;  ///< without the vertical part
  double pixel_m = 0;                      ///< geometric mean of a pixel's width and height on the ground
  std::array<double, 4> bounds{};          ///< min x, min y, max x, max y: degrees, or metres in a plane
};

/// The grid of a surface, and the indices of its rasters in ascending order.
struct SurfaceHead {
  Grid grid;
  int columns = 0, rows = 0;
  std::vector<std::size_t> heads;
};

/// Groups rasters with the same coordinate system and the same pixel grid, and sets the position of each part in the
/// grid. Returns the surfaces in the order of their first rasters.
std::vector<SurfaceHead> group_surfaces(std::vector<RasterHead>& heads);

/// Adds a warning to each part that touches or overlaps a part of another surface, because seams between surfaces are
/// not closed.
void warn_of_other_surfaces(const std::vector<SurfaceHead>& surfaces, std::vector<RasterHead>& heads);

}  // namespace gigabake
