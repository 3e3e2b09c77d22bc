/// Selection of the colour bands of an orthophoto, and of the range of values that is mapped to 8 bits.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "format/source/raster/gdal_raster.h"

namespace gigabake {

/// The bands of an orthophoto. Band numbers begin with 1.
struct OrthoBands {
  std::vector<int> colours;  ///< one band (grey, or palette indices), or red, green and blue
  int alpha = 0;             ///< 0: none
  bool is_palette = false;
  bool is_inverted = false;           ///< grey with 0 as white
  double max_value = 255;             ///< value of full intensity in the colour bands
  double max_alpha = 255;             ///< value of full opacity in the alpha band
  std::vector<std::string> warnings;  ///< one line each
};

/// Selects bands by the colour interpretations, the palette and the data type of a raster. Reads a sample of pixels of
/// 16-bit bands.
/// Errors  InputError(file, "ortho"): the range of the colours is unknown, or the colours are not red, green and blue.
OrthoBands ortho_bands(const std::filesystem::path& file, GDALDataset& dataset);

}  // namespace gigabake
