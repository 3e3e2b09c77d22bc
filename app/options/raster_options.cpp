#include "app/options/raster_options.h"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/error.h"
#include "format/source/raster/crs_map.h"

namespace gigabake::app {
namespace {

/// A stated offset replaces the vertical system, whose grid may then be missing.
void expect_known_crs(const RasterArguments& a) {
  if (a.crs.empty() || a.geoid_offset_m) return;
  try {
    open_crs_map(a.crs);
  } catch (const InputError& e) {
    throw UsageError(std::string("--dem-crs: ") + e.what());
  }
}

}  // namespace

void RasterArguments::add_to(CLI::App& command) {
  command.add_option("--ortho", ortho, "image with the colours of an elevation raster, such as photo.tif");
  command.add_option("--dem-crs", crs,
                     "coordinate system of an elevation raster, in place of the one it states, such as "
                     "EPSG:25832+7837");
  command.add_option("--nodata", nodata, "numbers that mark missing heights, such as -9999,0")->delimiter(',');
  command.add_option("--geoid-offset", geoid_offset_m,
                     "metres added to heights, in place of a vertical reference system; 0: heights are above the "
                     "ellipsoid");
}

RasterOptions RasterArguments::options() const {
  std::error_code error;
  if (!ortho.empty() && !std::filesystem::is_regular_file(ortho, error))
    throw UsageError(fmt::format("--ortho: no such file: '{}'", ortho));
  for (const double number : nodata)
    if (std::isinf(number)) throw UsageError("--nodata: expected finite numbers or nan");
  if (geoid_offset_m && !std::isfinite(*geoid_offset_m)) throw UsageError("--geoid-offset: expected finite metres");
  expect_known_crs(*this);
  return {ortho, crs, nodata, geoid_offset_m};
}

std::string RasterArguments::text() const {
  std::string out;
  const auto add = [&](const char* name, const std::string& value) {
    out += fmt::format("{}{} {}", out.empty() ? "" : " ", name, value);
  };
  if (!ortho.empty()) add("--ortho", ortho);
  if (!crs.empty()) add("--dem-crs", crs);
  if (!nodata.empty()) add("--nodata", fmt::format("{}", fmt::join(nodata, ",")));
  if (geoid_offset_m) add("--geoid-offset", fmt::format("{}", *geoid_offset_m));
  return out;
}

}  // namespace gigabake::app
