/// Checks that the declarations of a raster fit heights in metres above the ellipsoid.
#pragma once

#include <string>
#include <vector>

#include "format/source/raster/gdal_raster.h"

namespace gigabake {

/// Returns one warning per declaration of the raster that is not used, such as further bands or units.
/// Reads pixels only if the raster is rejected.
/// Errors  InputError names the key to set in the scene file. The raster is an image, or has elevation encoded as
///         colours, complex numbers, a scale of 0, depths, or heights in an unknown unit.
std::vector<std::string> check_dem(const DemOptions& options, GDALDataset& dataset);

/// Returns the band that is 0 at pixels without a value: the alpha band, else a mask; null if there is none.
GDALRasterBand* validity_band(GDALDataset& dataset);

/// Returns the metres of one unit of height. The unit is that of the options, else of the first band, else of the
/// vertical reference system.
/// Errors  InputError: the unit is unknown, or is a foot that may be either of two units.
double height_scale_of(const DemOptions& options, GDALDataset& dataset);

}  // namespace gigabake
