/// Which bands of an orthophoto are its colours, and how their numbers become 8 bits.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "format/source/raster/gdal_raster.h"

namespace gigabake {

/// Numbers of bands count from 1.
struct OrthoBands {
  std::vector<int> colours;  ///< one (grey, or indices of a palette), or red, green and blue
  int alpha = 0;             ///< or 0
  bool is_palette = false;
  bool is_inverted = false;           ///< grey whose 0 is white
  double max_value = 255;             ///< the number of full intensity
  std::vector<std::string> warnings;  ///< one line each
};

/// Reads colour interpretations, the palette and the type of a raster, and a sample of its 16-bit pixels.
/// Errors  InputError(file, "ortho"): numbers that have no range of colours, colours other than red, green and blue.
OrthoBands ortho_bands(const std::filesystem::path& file, GDALDataset& dataset);

}  // namespace gigabake
