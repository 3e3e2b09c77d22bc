#include "format/source/raster/gdal/gdal_crs.h"

#include <cmath>
#include <limits>
#include <mutex>
#include <vector>

#include "core/base/error.h"
#include "format/source/raster/gdal_raster.h"
#include "format/source/raster/proj_files.h"
#include "format/source/raster/proj_operations.h"

namespace gigabake {
namespace {

constexpr int wgs84_with_height = 4979;
/// Max distance between coordinates and the coordinates of their place, relative to their size.
constexpr double max_round_trip = 1e-6;

using Transformation = std::unique_ptr<OGRCoordinateTransformation>;

Transformation transformation(const OGRSpatialReference& from, const OGRSpatialReference& to) {
  OGRCoordinateTransformationOptions options;
  options.SetBallparkAllowed(false);
  return Transformation(OGRCreateCoordinateTransformation(&from, &to, options));
}

/// Returns the name of a unit of heights, as GDAL names units of bands.
std::string name_of_unit(double metres) {
  constexpr double foot_m = 0.3048, survey_foot_m = 1200.0 / 3937;
  for (const auto& [unit_m, name] :
       {std::pair(1.0, "m"), std::pair(foot_m, "ft"), std::pair(survey_foot_m, "US survey foot")})
    if (std::fabs(metres - unit_m) < 1e-9) return name;
  return std::to_string(metres) + " m";
}

CrsFacts facts_of(const OGRSpatialReference& crs) {
  CrsFacts out;
  out.wkt = wkt_of(crs);
  out.is_in_degrees = crs.IsGeographic() != 0;
  out.is_wgs84_degrees = out.is_in_degrees && crs.IsSame(OGRSpatialReference::GetWGS84SRS()) != 0;
  if (!out.is_in_degrees) out.metres_per_unit = crs.GetLinearUnits();
  const bool is_compound = crs.IsVertical() != 0;
  out.has_heights = is_compound || crs.GetAxesCount() == 3;
  double unit_m = 1;
  if (is_compound)
    unit_m = crs.GetTargetLinearUnits("VERT_CS");
  else if (out.has_heights)
    crs.GetAxis(nullptr, 2, nullptr, &unit_m);
  out.height_unit = name_of_unit(unit_m);
  return out;
}

/// A transformation is not thread-safe, so calls take turns.
class GdalCrsMap : public CrsMap {
 public:
  explicit GdalCrsMap(const std::string& text) {
    const QuietErrors quiet;
    OGRSpatialReference crs = crs_of_text("", "crs", text), degrees;
    if (crs.IsLocal() != 0)
      throw InputError("", "crs", in_quotes(text) + " is a local system without a place on earth");
    degrees.importFromEPSG(wgs84_with_height);
    for (OGRSpatialReference* system : {&crs, &degrees}) system->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    to_crs_ = transformation(degrees, crs);
    to_degrees_ = transformation(crs, degrees);
    if (!to_crs_ || !to_degrees_)
      throw InputError("", "crs", in_quotes(text) + " " + why_no_transformation(crs, degrees));
    facts_ = facts_of(crs);
  }

  void convert(std::span<std::array<double, 3>> points) const override { transform(*to_crs_, points); }
  void to_degrees(std::span<std::array<double, 3>> points) const override { transform(*to_degrees_, points); }
  const CrsFacts& facts() const override { return facts_; }

  bool has_place(const std::array<double, 3>& coordinates) const override {
    std::array<double, 3> p = coordinates;
    transform(*to_degrees_, {&p, 1});
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || std::fabs(p[1]) > 90) return false;
    transform(*to_crs_, {&p, 1});
    const double size = 1 + std::max(std::fabs(coordinates[0]), std::fabs(coordinates[1]));
    return std::hypot(p[0] - coordinates[0], p[1] - coordinates[1]) < max_round_trip * size;
  }

 private:
  void transform(OGRCoordinateTransformation& map, std::span<std::array<double, 3>> points) const {
    const std::scoped_lock lock(mutex_);
    const QuietErrors quiet;
    std::array<std::vector<double>, 3> axes;
    for (std::size_t c = 0; c < 3; ++c)
      for (const auto& p : points) axes[c].push_back(p[c]);
    std::vector<int> ok(points.size(), 0);
    map.Transform(points.size(), axes[0].data(), axes[1].data(), axes[2].data(), ok.data());
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c)
        points[i][c] = ok[i] != 0 && std::isfinite(axes[c][i]) ? axes[c][i] : std::numeric_limits<double>::quiet_NaN();
  }

  mutable std::mutex mutex_;
  Transformation to_crs_, to_degrees_;
  CrsFacts facts_;
};

}  // namespace

std::shared_ptr<const CrsMap> gdal_crs_map(const std::string& text) {
  confine_proj();
  return std::make_shared<const GdalCrsMap>(text);
}

}  // namespace gigabake
