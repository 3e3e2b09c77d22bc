#include "query/query_frames.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "format/area/crs_map.h"

namespace gigabake {
namespace {

double radians(double degrees) { return degrees * (std::numbers::pi / 180); }

QueryRay towards(const Vec3d& origin, const Vec3d& direction) {
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  if (!(length > 0) || !std::isfinite(length)) throw std::invalid_argument("the direction is zero");
  QueryRay ray;
  for (std::size_t a = 0; a < 3; ++a) {
    ray.origin[a] = origin[a];
    ray.direction[a] = direction[a] / length;
  }
  return ray;
}

}  // namespace

QueryFrames::QueryFrames(const SceneHeader& scene, const kernels::VoxelBox& window, QueryFrame frame,
                         std::shared_ptr<const CrsMap> crs)
    : frame_(frame),
      crs_(std::move(crs)),
      is_in_degrees_(frame == QueryFrame::lonlat || (crs_ && crs_->facts().is_in_degrees)),
      voxel_size_m_(scene.voxel_size_m),
      lattice_origin_m_(scene.lattice_origin_m),
      window_(window) {
  if (scene.origin) {
    scene_from_ecef_ = scene_from_ecef(*scene.origin);
    ecef_from_scene_ = ecef_from_enu(*scene.origin);
  } else if (frame != QueryFrame::scene) {
    throw UsageError(frame == QueryFrame::crs ? "crs" : "coordinates",
                     "the scene has no position on the earth; expected scene");
  }
}

QueryFrames::Vector QueryFrames::lattice_point(const QueryPoint& p) const {
  if (frame_ == QueryFrame::scene) return lattice_of({p[0], p[1], p[2]});
  return lattice_of_degrees(degrees_of(p));
}

QueryFrames::Vector QueryFrames::lattice_of_degrees(const QueryPoint& degrees) const {
  return lattice_of((*scene_from_ecef_)(ecef_of({degrees[1], degrees[0], degrees[2]})));
}

QueryFrames::Vector QueryFrames::lattice_of(const Point<Scene>& at) const {
  const Vector lattice{(at.x - lattice_origin_m_[0]) / voxel_size_m_, (at.y - lattice_origin_m_[1]) / voxel_size_m_,
                       (at.z - lattice_origin_m_[2]) / voxel_size_m_};
  for (const double v : lattice)
    if (!(std::fabs(v) <= double(kernels::far_voxel) / 4))
      throw std::invalid_argument("expected numbers within 2^50 voxels of the scene");
  return lattice;
}

QueryPoint QueryFrames::degrees_of(const QueryPoint& p) const {
  if (frame_ == QueryFrame::scene) return lonlat_point({p[0], p[1], p[2]});
  if (frame_ == QueryFrame::lonlat) {
    if (!(std::fabs(p[0]) <= 360) || !(std::fabs(p[1]) <= 90))
      throw std::invalid_argument("expected a longitude within ±360° and a latitude within ±90°, in this order");
    return p;
  }
  std::array<double, 3> point{p[0], p[1], p[2]};
  crs_->to_degrees({&point, 1});
  if (!std::isfinite(point[0]) || !std::isfinite(point[1]) || !std::isfinite(point[2]) || std::fabs(point[1]) > 90)
    throw std::invalid_argument(
        "the coordinates have no place on the earth in this system, or a grid of PROJ does not cover them");
  return {point[0], point[1], point[2]};
}

/// Returns the matrix whose columns are east, north and up at a place, in scene coordinates.
Affine<Scene, Scene> QueryFrames::axes_at(const QueryPoint& degrees) const {
  return *scene_from_ecef_ * ecef_from_enu({degrees[1], degrees[0], degrees[2]});
}

QueryRay QueryFrames::ray(const QueryPoint& from, const QueryPoint& direction) const {
  return towards(lattice_point(from), direction);
}

QueryRay QueryFrames::ray_by_angles(const QueryPoint& from, double azimuth_deg, double elevation_deg) const {
  if (!(std::fabs(elevation_deg) <= 90)) throw std::invalid_argument("expected an elevation within ±90°");
  const bool is_scene = frame_ == QueryFrame::scene;
  const QueryPoint degrees = is_scene ? QueryPoint{} : degrees_of(from);
  const Vector origin = is_scene ? lattice_point(from) : lattice_of_degrees(degrees);
  const double level = std::cos(radians(elevation_deg));
  const Vector local{std::sin(radians(azimuth_deg)) * level, std::cos(radians(azimuth_deg)) * level,
                     std::sin(radians(elevation_deg))};
  const Affine<Scene, Scene> axes = is_scene ? Affine<Scene, Scene>{} : axes_at(degrees);
  Vector direction{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) direction[r] += axes.m[r][c] * local[c];
  return towards(origin, direction);
}

QueryRay QueryFrames::ray_through(const QueryPoint& from, const QueryPoint& to) const {
  const Vector a = lattice_point(from), b = lattice_point(to);
  return towards(a, {b[0] - a[0], b[1] - a[1], b[2] - a[2]});
}

QueryRay QueryFrames::segment(const QueryPoint& from, const QueryPoint& to) const {
  const Vector a = lattice_point(from), b = lattice_point(to), way{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  if (way == Vector{}) throw std::invalid_argument("both points are the same");
  QueryRay ray = towards(a, way);
  ray.end = std::hypot(way[0], way[1], way[2]);
  return ray;
}

QueryRay QueryFrames::down(double x, double y) const {
  if (frame_ == QueryFrame::scene) {
    QueryRay ray = towards(lattice_point({x, y, lattice_origin_m_[2]}), {0, 0, -1});
    ray.origin[2] = double(window_.max[2]) + 1;
    return ray;
  }
  QueryPoint place = degrees_of({x, y, 0});
  place[2] = 0;
  const Affine<Scene, Scene> axes = axes_at(place);
  const Vector up{axes.m[0][2], axes.m[1][2], axes.m[2][2]};
  QueryRay ray = towards(lattice_of_degrees(place), {-up[0], -up[1], -up[2]});
  // Move the origin up along the local vertical, until the whole scene lies below the origin. In a large scene the
  // local vertical may differ from the scene's z axis. A ray from a place far outside the scene misses the scene's box.
  double rise = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double along = 0;
    for (int a = 0; a < 3; ++a)
      along += (double((corner >> a & 1) != 0 ? window_.max[a] : window_.min[a]) - ray.origin[a]) * up[std::size_t(a)];
    rise = corner == 0 ? along : std::fmax(rise, along);
  }
  for (int a = 0; a < 3; ++a) ray.origin[a] -= ray.direction[a] * (rise + 1);
  return ray;
}

Point<Scene> QueryFrames::scene_point(const QueryRay& ray, double distance) const {
  const auto at = [&](std::size_t a) {
    return lattice_origin_m_[a] + (ray.origin[a] + ray.direction[a] * distance) * voxel_size_m_;
  };
  return {at(0), at(1), at(2)};
}

QueryPoint QueryFrames::lonlat_point(const Point<Scene>& p) const {
  const Geodetic g = geodetic_of((*ecef_from_scene_)(p));
  return {g.longitude_deg, g.latitude_deg, g.height_m};
}

QueryPoint QueryFrames::point_in_query_frame(const Point<Scene>& p) const {
  if (frame_ == QueryFrame::scene) return {p.x, p.y, p.z};
  const QueryPoint degrees = lonlat_point(p);
  if (frame_ == QueryFrame::lonlat) return degrees;
  std::array<double, 3> point{degrees[0], degrees[1], degrees[2]};
  crs_->convert({&point, 1});
  if (!std::isfinite(point[0]) || !std::isfinite(point[1]) || !std::isfinite(point[2]))
    throw InputError("", "crs",
                     "an answer at longitude " + std::to_string(degrees[0]) + ", latitude " +
                         std::to_string(degrees[1]) +
                         " has no coordinates in this system, or a grid of PROJ does not cover it");
  return {point[0], point[1], point[2]};
}

}  // namespace gigabake
