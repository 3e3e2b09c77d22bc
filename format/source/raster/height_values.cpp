#include "format/source/raster/height_values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "core/base/error.h"

namespace gigabake {
namespace {

/// Numbers of at least this absolute value mark missing heights (the max float, 9.97e36 of netCDF, 1e20).
constexpr double huge = 1e15;
constexpr double common_marker = -9999;
/// Further numbers that mark missing heights unless they would be a usual height.
constexpr auto markers = std::to_array<double>({-9999, -32768, -32767, -99999, -999999, -2147483648.0, 9999, 32767,
                                                65535, 99999, 999999, 2147483647.0, 4294967295.0});
/// The range of usual heights contains almost all of the earth's surface. The range of plausible heights contains
/// the whole surface, with a margin. The Challenger Deep is at -10,935 m, Mount Everest at 8,849 m.
constexpr double lowest_usual_m = -9500, highest_usual_m = 9200;
constexpr double min_plausible_m = -11500, max_plausible_m = 9500;
/// The min distance from all other heights at which a single height is reported as suspicious.
constexpr double min_gap_m = 300;
constexpr std::size_t max_markers_named = 3;

std::string height_text(double v) {
  std::ostringstream text;
  text.precision(std::fabs(v) < huge ? 9 : 3);
  text << v;
  return text.str();
}

bool is_declared(double v, const std::vector<double>& nodata) {
  // Nodata in a tag is rounded text; for example, -3.40282e+38 means the lowest float.
  return std::any_of(nodata.begin(), nodata.end(), [&](double number) {
    return float(v) == float(number) || (std::fabs(v) >= huge && std::fabs(number) >= huge);
  });
}

bool is_marker(double v, double height_m, const HeightRule& rule) {
  if (std::fabs(v) >= huge) return true;
  if (v == common_marker && rule.scale == 1 && rule.offset == 0) return !rule.is_nodata_chosen;
  return (height_m < lowest_usual_m || height_m > highest_usual_m) &&
         std::find(markers.begin(), markers.end(), v) != markers.end();
}

/// The lowest, second lowest, second highest and highest height.
struct Extremes {
  double lowest = std::numeric_limits<double>::infinity(), second_lowest = lowest;
  double highest = -lowest, second_highest = -lowest;

  explicit Extremes(const std::vector<double>& height_m) {
    for (const double h : height_m) {
      if (std::isnan(h)) continue;
      lowest = std::min(lowest, h), highest = std::max(highest, h);
    }
    for (const double h : height_m) {
      if (h > lowest) second_lowest = std::min(second_lowest, h);
      if (h < highest) second_highest = std::max(second_highest, h);
    }
  }
};

void warn_of_gaps(const std::vector<double>& height_m, std::vector<std::string>& warnings) {
  const Extremes e(height_m);
  if (!(e.second_lowest <= e.second_highest)) return;  // fewer than three heights
  const auto warn = [&](const char* which, double height) {
    warnings.push_back(std::string("the ") + which + " height, " + height_text(height) + " m, is more than " +
                       height_text(min_gap_m) +
                       " m from all others near it; if it marks missing values, set it as \"nodata\" in a scene .json");
  };
  if (e.second_lowest - e.lowest > std::max(min_gap_m, e.highest - e.second_lowest)) warn("lowest", e.lowest);
  if (e.highest - e.second_highest > std::max(min_gap_m, e.second_highest - e.lowest)) warn("highest", e.highest);
}

[[noreturn]] void refuse_height(const std::filesystem::path& file, double height_m) {
  throw InputError(file, "height_scale",
                   "a pixel is " + height_text(height_m) +
                       " m high: no place on earth is; set height_scale (a foot: 0.3048) or nodata in a scene .json");
}

[[noreturn]] void refuse_markers(const std::filesystem::path& file, const std::set<double>& marked) {
  std::string numbers;
  std::size_t named = 0;
  for (const double v : marked)
    if (++named <= max_markers_named) numbers += (numbers.empty() ? "" : ", ") + height_text(v);
  throw InputError(file, "nodata",
                   "pixels of " + numbers +
                       " look like missing heights, but the raster does not declare this; set `nodata` (in a scene "
                       ".json \"nodata\") to the numbers that mark missing heights: " +
                       numbers + ", or other numbers if these are heights");
}

}  // namespace

std::vector<std::string> take_heights(const std::filesystem::path& file, const HeightRule& rule,
                                      std::vector<double>& values) {
  std::set<double> marked;
  for (double& v : values) {
    const double height_m = (v * rule.scale + rule.offset) * rule.unit_m + rule.geoid_offset_m;
    const bool is_missing = !std::isfinite(v) || is_declared(v, rule.nodata);
    if (!is_missing && is_marker(v, height_m, rule))
      marked.insert(v);
    else if (!is_missing && !rule.is_unit_chosen && (height_m < min_plausible_m || height_m > max_plausible_m))
      refuse_height(file, height_m);
    v = is_missing ? std::numeric_limits<double>::quiet_NaN() : height_m;
  }
  if (!marked.empty()) refuse_markers(file, marked);
  std::vector<std::string> warnings;
  warn_of_gaps(values, warnings);
  return warnings;
}

}  // namespace gigabake
