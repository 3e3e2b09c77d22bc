/// Where a mesh whose coordinates floats would round gets its origin, and what its vertices and its place then are.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "format/source/mesh.h"
#include "format/source/source.h"
#include "lattice/frames.h"

namespace gigabake {

/// So many vertices of a file's beginning are asked where on earth they stand.
inline constexpr std::size_t most_first_vertices = 64;

/// The extent of a mesh's positions, one after the other.
class PositionExtent {
 public:
  void add(const std::array<double, 3>& position);

  /// Returns the middle of the finite positions in whole metres if one is beyond 10 km, else zero.
  std::array<double, 3> origin() const;
  /// Returns the distance between two neighbouring floats at the largest coordinate, in the file's own unit; 0 if every
  /// coordinate is zero or not finite.
  float float_step() const;

 private:
  std::array<double, 3> low_{0, 0, 0}, high_{0, 0, 0};
  float largest_ = 0;
  bool is_far_ = false, is_empty_ = true;
};

/// The middle of all vertices that are finite, in whole metres, where some are beyond 10 km; else zero. What is left
/// after subtracting it is rounded to floats: projected coordinates keep their millimetres.
class MeshOrigin {
 public:
  MeshOrigin(const TileRef& tile, const PositionExtent& extent);
  MeshOrigin(const TileRef& tile, std::span<const std::array<double, 3>> positions);

  bool is_moved() const { return at_ != std::array<double, 3>{0, 0, 0}; }
  /// The mesh's place with this origin.
  const Affine<Scene, Local>& scene_from_local() const { return scene_from_local_; }
  void add_vertex(const std::array<double, 3>& position, Primitive& to) const;

 private:
  std::array<double, 3> at_;
  Affine<Scene, Local> scene_from_local_;
};

}  // namespace gigabake
