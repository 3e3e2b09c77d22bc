/// Edits of a source in the frame of a scene: the polygons' plane, and which boxes they affect.
///
/// Space   The plane of a polygon has metres of the scene's x and y, or degrees of longitude and latitude. Corners of
///         polygons are rounded to 2^-30 units.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/io/hash128.h"
#include "core/math/box3.h"
#include "core/math/frames.h"
#include "core/math/snap.h"
#include "format/area/area_in_scene.h"
#include "format/edit/source_edit.h"

namespace gigabake {

/// One edit. Thread-safe.
class SourceEditInScene {
 public:
  /// Errors  UsageError with file and key: degrees in a local scene.
  SourceEditInScene(const SourceEdit& edit, const std::optional<Geodetic>& origin);

  SourceEditType type() const { return type_; }
  const AreaPolygon& polygon() const { return polygon_; }
  const Hash128& hash() const { return hash_; }
  /// Returns the position of a point in the polygon's plane. Longitudes are continuous around the polygon.
  std::array<double, 2> in_plane(const Point<Scene>& p) const;
  /// Returns whether the edit moves surfaces along z.
  bool moves() const { return type_ == SourceEditType::flatten || type_ == SourceEditType::raise; }
  /// Returns the point to which the edit moves a point inside the polygon: with the same x and y. Heights above the
  /// ellipsoid are exact within a micrometre.
  /// Range   moves() is true.
  Point<Scene> moved(Point<Scene> p) const;
  /// Classifies a box against the polygon. May return `border` for a box that is inside or outside, but near the
  /// border.
  AreaOverlap overlap(const SceneRange& box) const;
  /// Returns whether the edit may change a surface in the box.
  bool affects(const SceneRange& box) const;
  /// Returns an interval of z that contains moved() of all points in the box.
  std::array<double, 2> moved_range(const SceneRange& box) const;

 private:
  SourceEditType type_;
  AreaPolygon polygon_;
  /// Returns the height at a position of the polygon's plane, of flatten.
  double height_at(const std::array<double, 2>& in_plane) const;

  double height_m_, by_m_;
  std::array<double, 2> level_at_{}, slope_{};  ///< where the height is height_m_, and metres per unit of the plane
  Hash128 hash_;
  double middle_longitude_ = 0;
  std::optional<AreaInScene> area_;  ///< of degrees
  std::optional<Affine<Ecef, Scene>> ecef_from_scene_;
};

using SourceEditsInScene = std::vector<SourceEditInScene>;

/// Returns the edits of a source in the scene.
/// Errors  UsageError like SourceEditInScene().
SourceEditsInScene placed_edits(const SourceEdits& edits, const std::optional<Geodetic>& origin);

/// Returns the box in the scene that contains a box of lod-0 voxels, extended by one voxel.
SceneRange range_of(const SnapFrame& frame, const Box3i64& voxels);

}  // namespace gigabake
