/// What a raster says of its numbers that does not fit heights in metres above the ellipsoid.
#pragma once

#include <string>
#include <vector>

#include "format/source/raster/gdal_raster.h"

namespace gigabake {

/// Returns one warning per thing that the raster says and that is not used: a vertical reference system, bands after
/// the first one, units. Reads pixels only where the raster is refused.
/// Errors  InputError naming the key of the scene file to set: an image or an encoded elevation in place of heights,
///         complex numbers, a scale of 0, depths, heights in another unit than metres.
std::vector<std::string> check_dem(const DemOptions& options, GDALDataset& dataset);

/// Returns the band that is 0 where a pixel has no value, or null: the alpha band, else a mask.
GDALRasterBand* validity_band(GDALDataset& dataset);

/// Returns metres of one unit of height: of the options, else of the first band's unit, else of the unit of the
/// vertical reference system. Errors  InputError: a unit that is unknown, or a foot that may be one of two.
double height_scale_of(const DemOptions& options, GDALDataset& dataset);

}  // namespace gigabake
