#include "format/source/raster/ellipsoid_heights.h"

#include <cmath>
#include <limits>

#include "core/base/error.h"

namespace gigabake {
namespace {

constexpr int epsg_of_ellipsoid = 4979;

std::string names_of(const std::vector<std::filesystem::path>& grids) {
  std::string out;
  for (const std::filesystem::path& grid : grids) out += (out.empty() ? "" : ", ") + grid.filename().string();
  return out;
}

}  // namespace

EllipsoidHeights::EllipsoidHeights(const DemOptions& options, GDALDataset& dataset, bool is_on_earth,
                                   const std::optional<LonLatBounds>& bounds) {
  if (!is_on_earth || options.geoid_offset_m) return;
  system_ = vertical_system_of(options, dataset);
  if (!system_ || (system_->is_ellipsoidal && !system_->whole)) return;
  ellipsoid_.importFromEPSG(epsg_of_ellipsoid);
  ellipsoid_.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  OGRCoordinateTransformationOptions no_guess;
  no_guess.SetBallparkAllowed(false);
  if (system_->whole) map_.reset(OGRCreateCoordinateTransformation(&*system_->whole, &ellipsoid_, no_guess));
  if (map_ || system_->is_ellipsoidal) return;
  const std::string why = system_->whole ? why_no_transformation(*system_->whole, ellipsoid_, bounds)
                                         : "cannot be combined with the horizontal coordinate system";
  throw InputError(
      options.dem, "crs",
      "the vertical reference system " + in_quotes(system_->name) + " " + why +
          "; else set `geoid_offset_m` (in a scene .json \"geoid_offset_m\"; 0: heights are above the ellipsoid)");
}

void EllipsoidHeights::convert(std::vector<double> x, std::vector<double> y, std::vector<double>& height_m) const {
  if (!map_ || height_m.empty()) return;
  const double unit_m = system_->is_depth ? -system_->unit_m : system_->unit_m;
  for (double& h : height_m) h /= unit_m;
  std::vector<int> ok(height_m.size(), 0);
  map_->Transform(height_m.size(), x.data(), y.data(), height_m.data(), ok.data());
  for (std::size_t i = 0; i < height_m.size(); ++i)
    if (ok[i] == 0 || !std::isfinite(height_m[i])) height_m[i] = std::numeric_limits<double>::quiet_NaN();
}

std::string EllipsoidHeights::why_not_covered(const LonLatBounds& area) const {
  std::string grids;
  if (const auto used = transformation(area)) grids = names_of(used->grids);
  return "the transformation of " + in_quotes(system_->name) + " to heights above the WGS84 ellipsoid" +
         (grids.empty() ? "" : " (grid " + grids + ")") + " does not cover the raster, which lies at longitude " +
         short_number(area[0]) + " to " + short_number(area[2]) + " and latitude " + short_number(area[1]) + " to " +
         short_number(area[3]) +
         "; set the right `dem_crs`, or `geoid_offset_m` (in a scene .json \"crs\", \"geoid_offset_m\")";
}

std::optional<UsedTransformation> EllipsoidHeights::transformation(const LonLatBounds& area) const {
  return map_ ? used_transformation(*system_->whole, ellipsoid_, area) : std::nullopt;
}

std::string heights_note(const DemOptions& options, const EllipsoidHeights& heights, const LonLatBounds& area) {
  if (options.geoid_offset_m) return "";
  if (!heights.system())
    return "states no vertical reference system: heights are taken as metres above the WGS84 ellipsoid; if they are "
           "above sea level, set `dem_crs` (such as EPSG:25832+7837) or `geoid_offset_m` (in a scene .json \"crs\", "
           "\"geoid_offset_m\")";
  const std::string name = in_quotes(heights.system()->name);
  if (heights.system()->is_ellipsoidal) return "heights are ellipsoidal (" + name + ")";
  std::string grids, accuracy;
  if (const auto used = heights.transformation(area)) {
    grids = names_of(used->grids);
    if (used->accuracy_m >= 0) accuracy = ", accuracy " + short_number(used->accuracy_m) + " m";
  }
  return "heights in " + name + " are converted to heights above the WGS84 ellipsoid (" +
         (grids.empty() ? "no grid" : "grid " + grids) + accuracy + ")";
}

}  // namespace gigabake
