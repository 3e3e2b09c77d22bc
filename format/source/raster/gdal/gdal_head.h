/// Reading and checking the headers of elevation rasters.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "format/source/raster/ground.h"
#include "format/source/raster/surface_parts.h"

namespace gigabake {

/// Returns sample points of a rectangle of pixels. The first point is the centre, because corners of a raster may lie
/// outside the domain of the projection.
std::vector<std::pair<double, double>> sample_points(double column, double row, double columns, double rows);

/// A place of a part that can be located, and the geometric mean of the pixel's width and height there.
struct LocatedPixel {
  Geodetic origin;
  double size_m = 0;
};

/// Returns the first sample point of a part that can be located, usually the centre. Checks the distance in metres of
/// neighbouring pixels at this point.
/// Errors  InputError: no sample point can be located, or the distance is implausible for the coordinate system.
LocatedPixel checked_pixel(const DemPart& part, const Grid& grid, const Ground& ground);

/// Reads the header of one raster and checks the raster. Reads elevation only if the raster is rejected.
RasterHead head_of(const DemOptions& options, bool is_local);

}  // namespace gigabake
