/// Orthophotos over the tiles of an elevation raster.
#pragma once

#include <string>
#include <vector>

#include "format/source/raster/gdal_raster.h"

namespace gigabake {

/// Bounds of a tile's image: more texels a cell than this are not kept.
inline constexpr int max_texture_edge = 4096, max_margin_texels = 64;
inline constexpr int max_texels_per_cell = max_texture_edge - 2 * max_margin_texels;

/// Returns the width of the image around a tile, in texels, so that filters meet no edge: at most one cell.
inline int margin_texels(int texels_per_cell) { return std::min(texels_per_cell, max_margin_texels); }

/// What an orthophoto means for an elevation raster.
struct OrthoFacts {
  double texels_per_cell = 1;         ///< of the orthophoto's own resolution
  std::vector<std::string> warnings;  ///< one line each, without the raster's name
};

/// Reads the head of a part's orthophoto, and samples of its pixels.
/// crs: of the raster, or null in a plane. Errors  InputError: colours that are not read; no place.
OrthoFacts check_ortho(const DemPart& part, const Grid& grid, const OGRSpatialReference* crs);

/// Returns the orthophotos over a tile and its margin as one image; grey where there is none.
EncodedImage read_ortho(const DemTile& tile, const OGRSpatialReference* crs);

}  // namespace gigabake
