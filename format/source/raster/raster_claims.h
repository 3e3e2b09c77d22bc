/// Memory that rasters are to take, compared with the limit before anything is allocated.
#pragma once

#include "format/source/raster/gdal_raster.h"

namespace gigabake {

/// Claims one tile while it is read: heights, places, vertices and triangles per pixel, and GDAL's own blocks.
/// Errors  InputError: beyond the limit.
void claim_tile(const DemOptions& options, GDALDataset& dataset);

/// Claims the list of a raster's tiles. edge: cells of a tile.
/// Errors  InputError: beyond the limit; too many tiles.
void claim_tiles(const DemRaster& raster, int edge);

/// Claims the image of one tile, if the raster has an orthophoto: its texels, the warped bands with their opacity, and
/// the encoded and decoded image.
/// Errors  InputError: beyond the limit.
void claim_image(const DemRaster& raster, int edge);

}  // namespace gigabake
