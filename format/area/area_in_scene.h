/// An area of interest in the frame of a scene: which voxels are inside.
///
/// Exact   A voxel is inside if its centre is. The centre is converted to the area's coordinates in double, by
///         GeographicLib and by the map of the coordinate system, and rounded to 2^-30 degrees or metres.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/io/hash128.h"
#include "core/math/box3.h"
#include "core/math/frames.h"
#include "core/math/snap.h"
#include "format/area/area.h"

namespace gigabake {

/// A closed box of positions in scene metres.
struct SceneRange {
  std::array<double, 3> low{}, high{};
};

/// Positions of a box that may be rotated or curved, in scene metres. They lie at the ends and in the middle of its
/// edges, faces and axes. Position x + 3y + 9z is at x/2, y/2, z/2 of the box.
using BoxSamples = std::array<Point<Scene>, 27>;
/// Returns the positions that `position` returns for three fractions of a box: 0, 1/2 or 1 along each axis.
template <class Position>
BoxSamples samples_of(const Position& position) {
  BoxSamples out;
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = position(double(i % 3) / 2, double(i / 3 % 3) / 2, double(i / 9) / 2);
  return out;
}

/// The voxels of a brick: bit x + 8y of word z, as in core/octree/octree.h.
using BrickMask = std::array<std::uint64_t, 8>;

/// Thread-safe.
class AreaInScene {
 public:
  /// `origin` is the origin of the scene on the earth; nullopt for a local scene.
  /// Errors  UsageError: the area has degrees or a coordinate system, and the scene is local.
  AreaInScene(std::shared_ptr<const Area> area, const std::optional<Geodetic>& origin);

  bool contains(const Point<Scene>& p) const;
  /// Classifies a box. `border` may also be returned for a box that is inside or outside, but near the border.
  AreaOverlap overlap(const SceneRange& box) const;
  AreaOverlap overlap(const BoxSamples& box) const;
  /// Classifies the centres of the voxels of level `lod` in a box of such voxels. Refines a box near the border, so
  /// that few boxes next to it count as `border`.
  AreaOverlap overlap(const SnapFrame& frame, const Box3i64& voxels, int lod = 0) const;
  /// Returns the voxels of a brick of level `lod` that are inside. `min` is its lowest voxel in voxels of that level.
  BrickMask inside(const SnapFrame& frame, const Vec3i64& min, int lod = 0) const;
  /// Returns a hash of the part of the area's border that lies in a box of lod-0 voxels. Areas with the same border
  /// there have the same hash.
  Hash128 border_hash(const SnapFrame& frame, const Box3i64& voxels) const;

 private:
  /// A box in the coordinates of the bounds or polygons.
  struct AreaBox {
    FixedBox plane;
    double height_low_m = 0, height_high_m = 0;
    bool is_known = true;  ///< false near a pole, and where the coordinate system has no coordinates
  };

  std::vector<std::array<double, 3>> in_frame(AreaFrame frame, std::span<const Point<Scene>> points) const;
  AreaBox box_in_frame(AreaFrame frame, const BoxSamples& box) const;
  AreaOverlap refined_overlap(const SceneRange& box, int splits) const;
  bool is_in_bounds(const std::array<double, 3>& p) const;
  bool is_in_polygons(const std::array<double, 3>& p) const;
  AreaOverlap overlap_of_bounds(const AreaBox& box) const;
  AreaOverlap overlap_of_polygons(const AreaBox& box) const;
  /// Writes the bounds that cut the box.
  void put_cutting_bounds(const BoxSamples& box, ByteWriter& w) const;
  /// Writes the edges of polygons that intersect the box, and which polygons contain its lowest corner.
  void put_cutting_edges(const BoxSamples& box, ByteWriter& w) const;

  std::shared_ptr<const Area> area_;
  std::optional<Affine<Ecef, Scene>> ecef_from_scene_;
};

}  // namespace gigabake
