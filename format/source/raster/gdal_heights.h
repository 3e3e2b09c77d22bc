/// Heights of a tile, from all parts of its surface.
#pragma once

#include <string>
#include <vector>

#include "format/source/raster/gdal_raster.h"

namespace gigabake {

/// Returns heights of a tile's vertices above the ellipsoid, row by row; NaN where there is no value.
/// Parts of the surface that the tile does not touch stay closed. Heights that no place on earth has are refused if the
/// raster is on the earth.
/// Errors  InputError: a part that cannot be read or changed since it was opened.
std::vector<double> read_heights(const DemTile& tile, bool is_on_earth, std::vector<std::string>& warnings);

/// Returns whether a part of a raster, columns × rows pixels, is known to have no value although nothing of it was
/// read: blocks that a sparse file leaves out, where these read as nodata.
bool is_known_empty(const DemOptions& options, GDALDataset& dataset, int column, int row, int columns, int rows);

/// Returns the fraction of blocks that a sparse file leaves out and that read as heights of 0.
double fraction_left_out(const DemOptions& options, GDALDataset& dataset);

}  // namespace gigabake
