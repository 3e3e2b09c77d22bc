/// 3D Tiles: bounding volumes of tiles, and their comparison with an area of interest.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/math/frames.h"
#include "core/math/world_box.h"
#include "format/area/area_in_scene.h"
#include "format/source/tiles/implicit_tiling.h"
#include "format/system/json/json_members.h"

namespace gigabake {

/// A bounding volume. A sphere is stored as the box around it.
struct BoundingVolume {
  enum class Shape : std::uint8_t { box, region };
  Shape shape = Shape::box;
  /// A box: its centre and half axes, in the tile's frame. A region: west, south, east, north in radians, and the
  /// heights of its lower and upper face; the rest is unused.
  std::array<double, 12> values{};
};

/// Returns the bounding volume of a tile; nullopt if it has none of a known type, or if its numbers are malformed.
std::optional<BoundingVolume> bounding_volume(const JsonMembers& tile);

/// Returns the volume of an implicit tile, from the volume of the root of its tiling.
BoundingVolume volume_of(const BoundingVolume& root, bool is_octree, const TileCoordinates& place);

BoundingVolume volume_of(const WorldBox& box);

/// A test of bounding volumes against the area of interest.
class VolumeFilter {
 public:
  /// `scene_from_world` places the tileset in a scene with this origin.
  /// Errors  UsageError: the area lies on the earth and the scene does not.
  VolumeFilter(std::shared_ptr<const Area> area, const std::optional<Geodetic>& origin,
               const Affine<Scene, World>& scene_from_world);

  /// Returns false if the volume and the area share no position. Returns true for a volume of more than 600 km.
  bool may_overlap(const BoundingVolume& volume, const Affine<World, World>& world_from_tile) const;

 private:
  AreaInScene area_;
  std::optional<Geodetic> origin_;
  Affine<Scene, World> scene_from_world_;
};

}  // namespace gigabake
