/// The coordinates that people ask in, and those of the voxels: scene metres, or longitude, latitude and height.
#pragma once

#include <array>
#include <optional>

#include "format/scene/scene_xml.h"
#include "lattice/frames.h"
#include "viewer/query/query_ray.h"

namespace gigabake {

enum class QueryFrame : std::uint8_t {
  scene,  ///< x east, y north, z up, metres
  lonlat  ///< longitude, latitude in degrees, metres above the ellipsoid; WGS84
};
template <>
constexpr auto names_of<QueryFrame>() {
  return std::to_array<std::string_view>({"scene", "lonlat"});
}

using QueryPoint = std::array<double, 3>;  ///< x, y, z, or longitude, latitude, height

/// Errors (of whoever says so)  std::invalid_argument: what was expected of the numbers, for who knows where they
/// stand.
class QueryFrames {
 public:
  /// Errors  UsageError: longitudes and latitudes of a scene that stands nowhere on earth.
  QueryFrames(const SceneHeader& scene, const kernels::VoxelBox& window, QueryFrame frame);

  QueryFrame frame() const { return frame_; }
  /// Whether the scene stands on earth.
  bool is_on_earth() const { return ecef_from_scene_.has_value(); }

  /// From there on in a direction of any length; along x, y, z of the scene.
  /// Errors  std::invalid_argument.
  QueryRay ray(const QueryPoint& from, const QueryPoint& direction) const;
  /// Degrees: azimuth from north to east, elevation above the horizon, where `from` is.
  QueryRay ray_by_angles(const QueryPoint& from, double azimuth_deg, double elevation_deg) const;
  /// Through another point and on.
  QueryRay ray_through(const QueryPoint& from, const QueryPoint& to) const;
  /// As far as to the other point.
  QueryRay segment(const QueryPoint& from, const QueryPoint& to) const;
  /// Straight down on x, y, or on longitude and latitude, from above the whole scene.
  QueryRay down(double x, double y) const;

  double metres(double voxels) const { return voxels * voxel_size_m_; }
  double voxels(double metres) const { return metres / voxel_size_m_; }
  Point<Scene> scene_point(const QueryRay& ray, double distance) const;
  /// In the frame that was asked in.
  QueryPoint asked_point(const Point<Scene>& p) const;
  /// Range  is_on_earth().
  QueryPoint lonlat_point(const Point<Scene>& p) const;

 private:
  using Vector = std::array<double, 3>;
  Vector lattice_point(const QueryPoint& p) const;
  Affine<Scene, Scene> axes_at(const QueryPoint& p) const;

  QueryFrame frame_;
  double voxel_size_m_;
  Vector lattice_origin_m_;
  kernels::VoxelBox window_;
  std::optional<Affine<Scene, Ecef>> scene_from_ecef_;
  std::optional<Affine<Ecef, Scene>> ecef_from_scene_;
};

}  // namespace gigabake
