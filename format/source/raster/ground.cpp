#include "format/source/raster/ground.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/math/georeference.h"

namespace gigabake {
namespace {

/// The range of semi-major axes of ellipsoids and spheres that are used for the earth.
constexpr double min_earth_radius_m = 6.3e6, max_earth_radius_m = 6.4e6;

Geodetic geodetic_place(double lon_deg, double lat_deg, double height_m) {
  return {std::clamp(lat_deg, -90.0, 90.0), std::remainder(lon_deg, 360.0), height_m};
}

}  // namespace

Ground::Ground(const DemOptions& options, GDALDataset& dataset) : crs_(crs_of(options, dataset)) {
  if (!crs_) return;
  if (crs_->IsLocal() != 0) {
    plane_unit_m_ = crs_->GetLinearUnits();
    return;
  }
  const double radius_m = crs_->GetSemiMajor();
  kind_ = radius_m > min_earth_radius_m && radius_m < max_earth_radius_m ? Kind::earth : Kind::body;
  OGRSpatialReference degrees;
  if (kind_ == Kind::earth) {
    degrees.importFromEPSG(4326);
  } else {
    const std::unique_ptr<OGRSpatialReference> geographic(crs_->CloneGeogCS());
    if (geographic) degrees = *geographic;
    radius_m_ = radius_m;
    const double flattening = crs_->GetInvFlattening() == 0 ? 0 : 1 / crs_->GetInvFlattening();
    eccentricity_squared_ = flattening * (2 - flattening);
  }
  degrees.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  map_.reset(OGRCreateCoordinateTransformation(&*crs_, &degrees));
  if (!map_) throw InputError(options.dem, "crs", "cannot be turned into longitude and latitude" + QuietErrors::last());
}

std::string Ground::why_not_on_earth() const {
  if (kind_ == Kind::earth) return "";
  if (!crs_)
    return "the raster has no coordinate system, or one that refers to files; set it in the scene file, as \"crs\": "
           "\"EPSG:25832\", or use `local`";
  return "the raster's coordinate system (" + name() + ") is " +
         (kind_ == Kind::body ? "of another body than the earth" : "a local one") +
         "; use `local`, or set \"crs\" in the scene file";
}

std::string Ground::name() const {
  const char* text = crs_ ? crs_->GetName() : nullptr;
  return text != nullptr ? text : "unnamed";
}

std::vector<char> Ground::locate(std::vector<double>& x, std::vector<double>& y) const {
  std::vector<char> is_located(x.size(), 1);
  if (kind_ == Kind::plane) {
    for (std::vector<double>* axis : {&x, &y})
      for (double& v : *axis) v *= plane_unit_m_;
    return is_located;
  }
  std::vector<int> ok(x.size(), 0);
  map_->Transform(x.size(), x.data(), y.data(), nullptr, ok.data());
  for (std::size_t i = 0; i < x.size(); ++i)
    is_located[i] = ok[i] != 0 && std::fabs(x[i]) <= 540 && std::fabs(y[i]) <= 90.0001 ? 1 : 0;
  return is_located;
}

Geodetic Ground::origin(double x, double y) const {
  return kind_ == Kind::plane ? Geodetic{y, x, 0} : geodetic_place(x, y, 0);
}

Point<Ecef> Ground::on_body(double lon_deg, double lat_deg, double height_m) const {
  if (kind_ == Kind::earth) return ecef_of(geodetic_place(lon_deg, lat_deg, height_m));
  const double lon = lon_deg * std::numbers::pi / 180, lat = lat_deg * std::numbers::pi / 180;
  const double normal = radius_m_ / std::sqrt(1 - eccentricity_squared_ * std::sin(lat) * std::sin(lat));
  return {(normal + height_m) * std::cos(lat) * std::cos(lon), (normal + height_m) * std::cos(lat) * std::sin(lon),
          (normal * (1 - eccentricity_squared_) + height_m) * std::sin(lat)};
}

Ground::Frame::Frame(const Ground& ground, const Geodetic& origin) : ground_(ground), origin_(origin) {
  if (ground.kind_ == Kind::plane) return;
  scene_from_body_ = scene_from_ecef(origin);
  if (ground.kind_ == Kind::earth) return;
  // The rotation depends only on latitude and longitude, so only the translation is replaced.
  const Point<Ecef> centre = ground.on_body(origin.longitude_deg, origin.latitude_deg, 0);
  for (auto& row : scene_from_body_.m) row[3] = -(row[0] * centre.x + row[1] * centre.y + row[2] * centre.z);
}

Point<Scene> Ground::Frame::operator()(double x, double y, double height_m) const {
  if (ground_.kind_ == Kind::plane) return {x - origin_.longitude_deg, y - origin_.latitude_deg, height_m};
  return scene_from_body_(ground_.on_body(x, y, height_m));
}

}  // namespace gigabake
