/// Checks that rasters fit into the memory limit, before memory is allocated.
#pragma once

#include "format/source/raster/gdal_raster.h"

namespace gigabake {

/// Checks that reading one tile stays within the memory limit. Counts the heights, positions, vertices and triangles
/// per pixel, and the blocks of GDAL.
/// Errors  InputError: the memory exceeds the limit.
void claim_tile(const DemOptions& options, GDALDataset& dataset);

/// Checks that the list of all tiles of a raster stays within the memory limit. `edge` is the edge of a tile in cells.
/// Errors  InputError: the memory exceeds the limit, or there are more than 2^22 tiles.
void claim_tiles(const DemRaster& raster, int edge);

/// Checks that the image of one tile stays within the memory limit, if the raster has an orthophoto. Counts the texels,
/// the warped bands with opacity, and the encoded and decoded image.
/// Errors  InputError: the memory exceeds the limit.
void claim_image(const DemRaster& raster, int edge);

}  // namespace gigabake
