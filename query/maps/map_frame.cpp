#include "query/maps/map_frame.h"

#include <GeographicLib/UTMUPS.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/math/georeference.h"

namespace gigabake {
namespace {

/// Returns the WKT of an engineering system: no program may take its coordinates for places on the earth.
std::string scene_wkt() {
  return R"(LOCAL_CS["scene frame of gigabake",UNIT["metre",1],AXIS["x",EAST],AXIS["y",NORTH]])";
}

}  // namespace

std::string default_map_crs(const SceneHeader& scene) {
  if (!scene.origin) return "scene";
  using GeographicLib::UTMUPS;
  const double latitude = scene.origin->latitude_deg;
  const int zone = UTMUPS::StandardZone(latitude, scene.origin->longitude_deg);
  const bool is_north = latitude >= 0;
  if (zone == UTMUPS::UPS) return is_north ? "EPSG:5041" : "EPSG:5042";
  return "EPSG:" + std::to_string((is_north ? 32600 : 32700) + zone);
}

MapFrame::MapFrame(const SceneHeader& scene) {
  facts_.wkt = scene_wkt();
  facts_.metres_per_unit = 1;
  if (!scene.origin) return;
  ecef_from_scene_ = ecef_from_enu(*scene.origin);
  scene_from_ecef_ = scene_from_ecef(*scene.origin);
}

MapFrame::MapFrame(const SceneHeader& scene, const OpenCrs& open, int threads) : MapFrame(scene) {
  if (!scene.origin) throw UsageError("crs", "the scene has no position on the earth; expected scene");
  for (int t = 0; t < threads; ++t) maps_.push_back(open());
  facts_ = maps_.front()->facts();
}

void MapFrame::to_query(Points points, int thread) const {
  if (!is_scene() && !facts_.is_wgs84_degrees) maps_[std::size_t(thread)]->to_degrees(points);
}

void MapFrame::to_map(Points points, int thread) const {
  if (!is_scene() && !facts_.is_wgs84_degrees) maps_[std::size_t(thread)]->convert(points);
}

void MapFrame::scene_to_map(Points points, int thread) const {
  if (is_scene()) return;
  for (auto& p : points) {
    const Geodetic g = geodetic_of((*ecef_from_scene_)({p[0], p[1], p[2]}));
    p = {g.longitude_deg, g.latitude_deg, g.height_m};
  }
  to_map(points, thread);
}

MapBox MapFrame::box_of(const std::array<Vec3d, 2>& corners, const std::function<void(Points)>& convert,
                        double margin) const {
  constexpr int steps = 32;
  std::vector<std::array<double, 3>> points;
  for (const double z : {corners[0][2], corners[1][2]})
    for (int y = 0; y <= steps; ++y)
      for (int x = 0; x <= steps; ++x)
        points.push_back({std::lerp(corners[0][0], corners[1][0], double(x) / steps),
                          std::lerp(corners[0][1], corners[1][1], double(y) / steps), z});
  convert(points);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  MapBox box{{infinity, infinity}, {-infinity, -infinity}};
  for (const auto& p : points)
    for (std::size_t c = 0; c < 2; ++c) {
      if (!std::isfinite(p[0]) || !std::isfinite(p[1])) continue;
      box.low[c] = std::min(box.low[c], p[c] - margin);
      box.high[c] = std::max(box.high[c], p[c] + margin);
    }
  if (box.is_empty()) throw InputError("", "crs", "the scene has no coordinates in this system");
  return box;
}

MapBox MapFrame::box_of_scene(const Vec3d& low, const Vec3d& high, double margin) const {
  return box_of(
      {low, high}, [&](Points points) { scene_to_map(points); }, margin);
}

MapBox MapFrame::box_of_degrees(const MapBox& degrees, const std::array<double, 2>& heights_m, double margin) const {
  const auto convert = [&](Points points) {
    if (!is_scene()) return to_map(points);
    for (auto& p : points) {
      const Point<Scene> at = (*scene_from_ecef_)(ecef_of({p[1], p[0], p[2]}));
      p = {at.x, at.y, at.z};
    }
  };
  return box_of(
      {Vec3d{degrees.low[0], degrees.low[1], heights_m[0]}, Vec3d{degrees.high[0], degrees.high[1], heights_m[1]}},
      convert, margin);
}

}  // namespace gigabake
