/// Conversion between the coordinates of queries (scene metres, or longitude, latitude and height) and voxels.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "core/math/frames.h"
#include "core/math/vec3.h"
#include "format/scene/xml/scene_xml.h"
#include "query/first_hit/query_ray.h"

namespace gigabake {

class CrsMap;

enum class QueryFrame : std::uint8_t {
  scene,   ///< x east, y north, z up, metres
  lonlat,  ///< longitude, latitude in degrees, metres above the ellipsoid; WGS84
  crs      ///< x (easting or longitude), y and height of a coordinate system; without a vertical part of the system,
           ///< metres above the ellipsoid
};
template <>
constexpr auto names_of<QueryFrame>() {
  return std::to_array<std::string_view>({"scene", "lonlat", "crs"});
}

using QueryPoint = Vec3d;  ///< x, y, z; or longitude, latitude, height; or x, y, height

/// A converter of query coordinates to rays in voxels, and of results back to query coordinates.
/// Errors  The functions that return rays throw std::invalid_argument with the expected range. The caller adds the
///         position in the input.
class QueryFrames {
 public:
  /// Takes the coordinate system of QueryFrame::crs; null for other frames.
  /// Errors  UsageError: lonlat or crs for a scene that is not georeferenced.
  QueryFrames(const SceneHeader& scene, const kernels::VoxelBox& window, QueryFrame frame,
              std::shared_ptr<const CrsMap> crs = nullptr);

  QueryFrame frame() const { return frame_; }
  /// Returns whether the scene is georeferenced.
  bool is_on_earth() const { return ecef_from_scene_.has_value(); }
  /// Returns whether the first two coordinates of a point are degrees.
  bool is_in_degrees() const { return is_in_degrees_; }

  /// Returns the ray from a point in a direction of any length. `direction` has components along x, y and z of the
  /// scene.
  /// Errors  std::invalid_argument.
  QueryRay ray(const QueryPoint& from, const QueryPoint& direction) const;
  /// Returns the ray from `from` with an azimuth clockwise from north and an elevation above the horizon, in degrees.
  /// In QueryFrame::scene, north is the scene's y axis; otherwise north and horizon are local to `from`.
  QueryRay ray_by_angles(const QueryPoint& from, double azimuth_deg, double elevation_deg) const;
  /// Returns the unbounded ray from one point through another.
  QueryRay ray_through(const QueryPoint& from, const QueryPoint& to) const;
  /// Returns the ray from `from` that ends at `to`.
  QueryRay segment(const QueryPoint& from, const QueryPoint& to) const;
  /// Returns the ray straight down at the first two coordinates, from above the whole scene. Down is along the normal
  /// of the ellipsoid, or along the scene's z axis.
  QueryRay down(double x, double y) const;

  double metres(double voxels) const { return voxels * voxel_size_m_; }
  double voxels(double metres) const { return metres / voxel_size_m_; }
  Point<Scene> scene_point(const QueryRay& ray, double distance) const;
  /// Returns the point in the frame of the queries.
  /// Errors  InputError: the point has no coordinates in the coordinate system.
  QueryPoint point_in_query_frame(const Point<Scene>& p) const;
  /// Returns the point as longitude, latitude and height.
  /// Range   is_on_earth() is true.
  QueryPoint lonlat_point(const Point<Scene>& p) const;
  /// Returns a point of the query's frame as longitude, latitude and height.
  /// Range   is_on_earth() is true.
  /// Errors  std::invalid_argument: the coordinates have no place on the earth.
  QueryPoint degrees_of(const QueryPoint& p) const;

 private:
  using Vector = Vec3d;
  Vector lattice_point(const QueryPoint& p) const;
  Vector lattice_of_degrees(const QueryPoint& degrees) const;
  Vector lattice_of(const Point<Scene>& p) const;
  Affine<Scene, Scene> axes_at(const QueryPoint& degrees) const;

  QueryFrame frame_;
  std::shared_ptr<const CrsMap> crs_;
  bool is_in_degrees_ = false;
  double voxel_size_m_;
  Vector lattice_origin_m_;
  kernels::VoxelBox window_;
  std::optional<Affine<Scene, Ecef>> scene_from_ecef_;
  std::optional<Affine<Ecef, Scene>> ecef_from_scene_;
};

}  // namespace gigabake
