/// Reading of the heights of a tile from all parts of its surface.
#pragma once

#include <string>
#include <vector>

#include "format/source/raster/ground.h"

namespace gigabake {

/// Returns the heights of a tile's vertices above the ellipsoid, row by row; NaN for vertices without a value.
/// Opens only the files (DemPart) that overlap the tile.
/// Errors  InputError: a part cannot be read or was changed since it was opened. On the earth also if a height does not
///         occur there, or the transformation of heights to the ellipsoid does not cover a height.
std::vector<double> read_heights(const DemTile& tile, const Ground& ground, std::vector<std::string>& warnings);

/// Returns true if a window of columns × rows pixels is known to have no value. For this, a sparse file must omit all
/// blocks of the window, and omitted blocks must read as nodata or be masked. Reads no pixels.
bool is_known_empty(const DemOptions& options, GDALDataset& dataset, int column, int row, int columns, int rows);

/// Divides the raster into tiles of `edge` cells. Returns one flag per tile, row by row: 0 if the tile is known to have
/// no value, otherwise 1. Opens the files of a mosaic (VRT), because GDAL reports the areas of all its files as filled.
/// Errors  InputError: a file cannot be opened.
std::vector<char> filled_tiles(const DemRaster& raster, int edge);

/// Returns the fraction of the raster that a sparse file omits and that is read as heights of 0.
double fraction_left_out(const DemOptions& options, GDALDataset& dataset);

}  // namespace gigabake
