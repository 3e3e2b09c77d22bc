/// The edits of a scene on the lattice of a bake: which voxels each selects.
///
/// Exact   A voxel is selected if its centre is inside the shape. Shapes in metres, spheres and cylinders in degrees
///         are rounded to the lattice once (lattice_shape.h). Boxes and prisms in degrees select like areas of interest
///         (format/area/area_in_scene.h): the centre is converted to degrees in double and rounded to 2^-30.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <variant>
#include <vector>

#include "core/math/box3.h"
#include "core/math/frames.h"
#include "core/math/snap.h"
#include "format/area/area_in_scene.h"
#include "format/edit/edit.h"
#include "format/edit/lattice_shape.h"

namespace gigabake {

/// Thread-safe. Edits are named by their indices in the list.
class EditsInScene {
 public:
  /// `origin` is the origin of the scene on the earth; nullopt for a local scene.
  /// Errors  UsageError with file and key: a shape in degrees in a local scene, a shape wider than 2^21 voxels or 300
  ///         km, or a coordinate that does not fit the lattice.
  EditsInScene(std::shared_ptr<const EditList> edits, const std::optional<Geodetic>& origin, const SnapFrame& frame);

  std::size_t size() const { return placed_.size(); }
  const Edit& edit(std::uint32_t i) const { return (*edits_)[i]; }
  /// Returns a box of lod-0 voxels that contains all voxels that the edit selects.
  const Box3i64& bounds(std::uint32_t i) const { return placed_[i].bounds; }
  /// Returns hash_of() the edit.
  const Hash128& hash(std::uint32_t i) const { return placed_[i].hash; }

  /// Returns the edits that select at least one voxel of a cube, in their order.
  /// Range   `cube` is a cube whose edge is a power of two, and at least a brick.
  /// Cost    Proportional to the edits whose bounds are near the cube. An edit that only touches a face of the cube
  ///         costs a test per brick there.
  std::vector<std::uint32_t> selecting(const Box3i64& cube) const;
  /// Returns whether the edit selects a voxel of a cube, as selecting().
  bool selects_any(std::uint32_t i, const Box3i64& cube) const;
  /// Classifies the voxels of a box. May return `border` for a box that is inside or outside, but near the border.
  AreaOverlap overlap(std::uint32_t i, const Box3i64& voxels) const;
  /// Returns the voxels of a brick that the edit selects. `min` is its lowest voxel.
  BrickMask selected(std::uint32_t i, const Vec3i64& min) const;
  bool selects(std::uint32_t i, const Vec3i64& voxel) const;

 private:
  struct PlacedEdit {
    std::variant<LatticeShape, AreaInScene> shape;
    Box3i64 bounds;
    Hash128 hash;
  };
  class Placer;

  /// Returns the edits whose bounds may overlap the box, sorted.
  std::vector<std::uint32_t> near(const Box3i64& box) const;

  std::shared_ptr<const EditList> edits_;
  SnapFrame frame_;
  std::vector<PlacedEdit> placed_;
  /// Edits by block of columns, and those that overlap too many blocks to be listed there.
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> by_block_;
  std::vector<std::uint32_t> wide_;
};

}  // namespace gigabake
