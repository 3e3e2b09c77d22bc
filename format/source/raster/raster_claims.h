/// Checks of the memory that rasters need against the limit, before memory is allocated.
#pragma once

#include "format/source/raster/gdal_raster.h"

namespace gigabake {

/// Checks the memory to read one tile: heights, positions, vertices and triangles per pixel, and the blocks of GDAL.
/// Errors  InputError: the memory exceeds the limit.
void claim_tile(const DemOptions& options, GDALDataset& dataset);

/// Checks the memory of the list of a raster's tiles. `edge` is the edge of a tile in cells.
/// Errors  InputError: the memory exceeds the limit, or there are more than 2^22 tiles.
void claim_tiles(const DemRaster& raster, int edge);

/// Checks the memory of the image of one tile, if the raster has an orthophoto. Counts the texels, the warped bands
/// with opacity, and the encoded and decoded image.
/// Errors  InputError: the memory exceeds the limit.
void claim_image(const DemRaster& raster, int edge);

}  // namespace gigabake
