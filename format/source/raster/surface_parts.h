/// Which rasters form one surface.
#pragma once

#include <vector>

#include "format/source/raster/gdal_raster.h"

namespace gigabake {

/// A raster that is to be part of a surface.
struct RasterHead {
  DemPart part;  ///< its place in the surface is not set yet
  Grid grid;
  std::optional<OGRSpatialReference> crs;  ///< without its vertical part
  std::array<double, 4> bounds{};          ///< least x and y, greatest x and y: degrees, or metres in a plane
};

/// A surface's grid and the heads in it, by their numbers; parts are in the order of these numbers.
struct SurfaceHead {
  Grid grid;
  int columns = 0, rows = 0;
  std::vector<std::size_t> heads;
};

/// Groups rasters of one coordinate system whose pixels lie on one grid, and sets each part's place in it.
/// Returns surfaces in the order of their first rasters.
std::vector<SurfaceHead> group_surfaces(std::vector<RasterHead>& heads);

/// Adds a warning to each part that touches or overlaps a part of another surface: no seam is closed there.
void warn_of_other_surfaces(const std::vector<SurfaceHead>& surfaces, std::vector<RasterHead>& heads);

}  // namespace gigabake
