/// The coordinates of a map: metres of the scene's frame, or a coordinate system on the earth.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/math/box3.h"
#include "format/area/crs_map.h"
#include "format/scene/xml/scene_xml.h"
#include "query/query_frames.h"

namespace gigabake {

/// A box of map coordinates.
struct MapBox {
  std::array<double, 2> low{}, high{};
  bool is_empty() const { return !(low[0] < high[0] && low[1] < high[1]); }
};

/// Returns the coordinate system of maps of a scene: the zone of UTM at its origin, such as "EPSG:32632", or UPS near a
/// pole. Zones include the exceptions in Norway. Returns "scene" for a scene without a place on the earth.
std::string default_map_crs(const SceneHeader& scene);

/// Conversions between map coordinates, scene metres and degrees. Thread-safe for different values of `thread`.
class MapFrame {
 public:
  using OpenCrs = std::function<std::shared_ptr<const CrsMap>()>;
  using Points = std::span<std::array<double, 3>>;

  /// Returns the scene's own frame.
  explicit MapFrame(const SceneHeader& scene);
  /// `open` opens the coordinate system once per thread, because the calls of a CrsMap take turns.
  /// Errors  UsageError: the scene has no place on the earth. Errors of `open`.
  MapFrame(const SceneHeader& scene, const OpenCrs& open, int threads);

  /// Returns whether map coordinates are scene metres.
  bool is_scene() const { return maps_.empty(); }
  /// Returns the frame in which rays are cast for pixels of the map.
  QueryFrame query_frame() const { return is_scene() ? QueryFrame::scene : QueryFrame::lonlat; }
  const CrsFacts& facts() const { return facts_; }

  /// Replaces x, y and height of the map by coordinates of query_frame(). Points without a place become NaN.
  void to_query(Points points, int thread = 0) const;
  /// Replaces coordinates of query_frame() by x, y and height of the map.
  void to_map(Points points, int thread = 0) const;
  /// Replaces x, y, z in scene metres by x, y and height of the map.
  void scene_to_map(Points points, int thread = 0) const;

  /// Returns the map coordinates of a box of scene metres, widened by `margin`. Edges of the box may be curved on the
  /// map; the box contains 33 places along each.
  /// Errors  InputError: no place of the box has coordinates.
  MapBox box_of_scene(const Vec3d& low, const Vec3d& high, double margin) const;
  /// Returns the map coordinates of a box of degrees, like box_of_scene(). In the scene's frame, places are at the
  /// heights of `heights_m`.
  MapBox box_of_degrees(const MapBox& degrees, const std::array<double, 2>& heights_m, double margin) const;

 private:
  MapBox box_of(const std::array<Vec3d, 2>& corners, const std::function<void(Points)>& convert, double margin) const;

  std::optional<Affine<Ecef, Scene>> ecef_from_scene_;
  std::optional<Affine<Scene, Ecef>> scene_from_ecef_;
  std::vector<std::shared_ptr<const CrsMap>> maps_;  ///< one per thread; empty: the scene's frame
  CrsFacts facts_;
};

}  // namespace gigabake
