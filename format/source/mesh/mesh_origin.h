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

/// The middle of all vertices that are finite, in whole metres, where some are beyond 10 km; else zero. What is left
/// after subtracting it is rounded to floats: projected coordinates keep their millimetres.
class MeshOrigin {
 public:
  MeshOrigin(const TileRef& tile, std::span<const std::array<double, 3>> positions);

  bool is_moved() const { return at_ != std::array<double, 3>{0, 0, 0}; }
  /// The mesh's place with this origin.
  const Affine<Scene, Local>& scene_from_local() const { return scene_from_local_; }
  void add_vertex(const std::array<double, 3>& position, Primitive& to) const;

 private:
  std::array<double, 3> at_;
  Affine<Scene, Local> scene_from_local_;
};

/// Between two neighbouring floats of the largest coordinate's size, in the file's own unit; 0 where there is none.
float float_step_of(std::span<const std::array<double, 3>> positions);

}  // namespace gigabake
