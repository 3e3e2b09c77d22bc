/// Conversion between the coordinates of queries (scene metres, or longitude, latitude and height) and voxels.
#pragma once

#include <array>
#include <optional>

#include "core/math/frames.h"
#include "core/math/vec3.h"
#include "format/scene/xml/scene_xml.h"
#include "query/first_hit/query_ray.h"

namespace gigabake {

enum class QueryFrame : std::uint8_t {
  scene,  ///< x east, y north, z up, metres
  lonlat  ///< longitude, latitude in degrees, metres above the ellipsoid; WGS84
};
template <>
constexpr auto names_of<QueryFrame>() {
  return std::to_array<std::string_view>({"scene", "lonlat"});
}

using QueryPoint = Vec3d;  ///< x, y, z, or longitude, latitude, height

/// A converter of query coordinates to rays in voxels, and of results back to query coordinates.
/// Errors  The functions that return rays throw std::invalid_argument with the expected range. The caller adds the
///         position in the input.
class QueryFrames {
 public:
  /// Errors  UsageError: lonlat for a scene that is not georeferenced.
  QueryFrames(const SceneHeader& scene, const kernels::VoxelBox& window, QueryFrame frame);

  QueryFrame frame() const { return frame_; }
  /// Returns whether the scene is georeferenced.
  bool is_on_earth() const { return ecef_from_scene_.has_value(); }

  /// Returns the ray from a point in a direction of any length. `direction` has components along x, y and z of the
  /// scene.
  /// Errors  std::invalid_argument.
  QueryRay ray(const QueryPoint& from, const QueryPoint& direction) const;
  /// Returns the ray from `from` with an azimuth clockwise from north and an elevation above the horizon, in degrees.
  /// In QueryFrame::lonlat, north and horizon are local to `from`; otherwise north is the scene's y axis.
  QueryRay ray_by_angles(const QueryPoint& from, double azimuth_deg, double elevation_deg) const;
  /// Returns the unbounded ray from one point through another.
  QueryRay ray_through(const QueryPoint& from, const QueryPoint& to) const;
  /// Returns the ray from `from` that ends at `to`.
  QueryRay segment(const QueryPoint& from, const QueryPoint& to) const;
  /// Returns the ray straight down at x, y or at longitude, latitude, from above the whole scene.
  QueryRay down(double x, double y) const;

  double metres(double voxels) const { return voxels * voxel_size_m_; }
  double voxels(double metres) const { return metres / voxel_size_m_; }
  Point<Scene> scene_point(const QueryRay& ray, double distance) const;
  /// Returns the point in the frame of the queries.
  QueryPoint point_in_query_frame(const Point<Scene>& p) const;
  /// Returns the point as longitude, latitude and height.
  /// Range   is_on_earth() is true.
  QueryPoint lonlat_point(const Point<Scene>& p) const;

 private:
  using Vector = Vec3d;
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
