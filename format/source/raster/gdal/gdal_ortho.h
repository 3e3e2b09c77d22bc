/// Orthophotos on the tiles of an elevation raster.
#pragma once

#include <string>
#include <vector>

#include "format/source/raster/gdal_raster.h"

namespace gigabake {

/// Bounds of the image of a tile: max edge, max margin and max texels per cell. Higher resolutions are reduced.
inline constexpr int max_texture_edge = 4096, max_margin_texels = 64;
inline constexpr int max_texels_per_cell = max_texture_edge - 2 * max_margin_texels;

/// Returns the margin of the image around a tile, in texels: at most one cell. Filters need it at the border of the
/// tile.
inline int margin_texels(int texels_per_cell) { return std::min(texels_per_cell, max_margin_texels); }

/// The properties of an orthophoto that an elevation raster needs.
struct OrthoFacts {
  double texels_per_cell = 1;         ///< at the native resolution of the orthophoto
  std::vector<std::string> warnings;  ///< one line each, without the raster's name
};

/// Reads the header of a part's orthophoto, and samples of its pixels. `crs` is the coordinate system of the raster, or
/// null in a plane.
/// Errors  InputError: the colours are not supported, or the location of the orthophoto is unknown.
OrthoFacts check_ortho(const DemPart& part, const Grid& grid, const OGRSpatialReference* crs);

/// Returns the orthophotos on a tile and its margin as one image; texels without an orthophoto are grey.
EncodedImage read_ortho(const DemTile& tile, const OGRSpatialReference* crs);

}  // namespace gigabake
