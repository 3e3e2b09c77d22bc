/// A raster's numbers as heights: which of them mark pixels without a height, and which cannot be heights.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "format/source/raster/dem.h"

namespace gigabake {

/// How a raster stores heights: (number · scale + offset) · unit_m + geoid_offset_m is metres above the ellipsoid.
struct HeightRule {
  double nodata = std::numeric_limits<double>::quiet_NaN();  ///< the number that the raster declares as "no height"
  double scale = 1, offset = 0, unit_m = 1, geoid_offset_m = 0;
  bool is_nodata_chosen = false;  ///< the scene file sets `nodata`: -9999 may then be a height
  bool is_unit_chosen = false;    ///< the scene file sets `height_scale`: any height may be meant
};

/// Replaces numbers by heights in metres, NaN where there is none.
/// Numbers that commonly mark missing heights (-9999, -32768, ±3.4e38 …) become NaN also where the raster does not
/// declare them: such a decision depends on the number alone, so that neighbouring tiles agree.
/// Returns one warning per number that was taken so, and per number that lies far from all others of the window (0 or
/// -999 in a landscape at 1500 m), which stays a height.
/// Errors  InputError(file, "height_scale"): a height that no place on earth has.
std::vector<std::string> take_heights(const std::filesystem::path& file, const HeightRule& rule,
                                      std::vector<double>& values);

}  // namespace gigabake
