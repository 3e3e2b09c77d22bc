/// Conversion of a raster's numbers to heights, with detection of missing and impossible heights.
#pragma once

#include <string>
#include <vector>

#include "format/source/raster/dem.h"

namespace gigabake {

/// The encoding of heights in a raster. Metres above the ellipsoid are
/// (number · scale + offset) · unit_m + geoid_offset_m.
struct HeightRule {
  std::vector<double> nodata;  ///< numbers declared as "no height"
  double scale = 1, offset = 0, unit_m = 1, geoid_offset_m = 0;
  bool is_nodata_chosen = false;  ///< the user states `nodata`, so -9999 may be a height
  bool is_unit_chosen = false;    ///< the user states `height_scale`, so any height is plausible
};

/// Replaces numbers by heights in metres, or by NaN for missing heights.
/// Returns a warning of the lowest or highest height if it is far from all others of the window, for example 0 in a
/// landscape at 1500 m. Such a number remains a height.
/// Errors  InputError(file, "nodata"): a number commonly marks missing heights (-9999, -32768, ±3.4e38 …), and neither
///         the raster nor the user declares it. InputError(file, "height_scale"): a height does not occur on earth.
std::vector<std::string> take_heights(const std::filesystem::path& file, const HeightRule& rule,
                                      std::vector<double>& values);

}  // namespace gigabake
