/// A closed mesh on the lattice of a bake: whether a position is inside.
///
/// Space   Sub-voxels (1/256 voxel) from the lattice origin.
/// Exact   A position is inside if its winding number is not 0: the sum over the surfaces strictly above it, +1 for
///         each that faces up and -1 for each that faces down. A vertical ray through an edge or a vertex follows the
///         rule of polygons (format/area/polygon.h), so that it crosses one triangle there. All tests use integers.
/// Ties    A position on a surface is below that surface's upper side and above its lower side: a lower surface is
///         inside, an upper surface is outside. Western and southern faces are inside, eastern and northern outside.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/math/vec3.h"
#include "format/area/polygon.h"

namespace gigabake {

class LatticeMesh {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  /// Errors  std::length_error: the mesh has too many triangles per area to be indexed.
  /// Range   Indices are less than positions.size(); the box around the positions has edges of at most
  ///         max_shape_edge (lattice_shape.h).
  LatticeMesh(std::vector<Vec3i64> positions, std::vector<Triangle> triangles);

  const Vec3i64& low() const { return low_; }
  const Vec3i64& high() const { return high_; }
  /// Range   The position is in the box around the mesh, or near it.
  bool contains(const Vec3i64& p) const;
  /// Classifies the positions in a closed box. May return `border` for any box.
  AreaOverlap overlap(const Vec3i64& low, const Vec3i64& high) const;

 private:
  using Block = std::array<std::int64_t, 2>;
  struct BlockHash {
    std::size_t operator()(const Block& b) const { return std::size_t(b[0] * 0x9e3779b97f4a7c15 ^ b[1]); }
  };

  bool is_near(std::uint32_t triangle, const Vec3i64& low, const Vec3i64& high) const;
  int winding_below(const Triangle& triangle, const Vec3i64& p) const;

  std::vector<Vec3i64> positions_;
  std::vector<Triangle> triangles_;
  Vec3i64 low_{}, high_{};
  /// Triangles by block of columns of voxels that their boxes overlap.
  std::unordered_map<Block, std::vector<std::uint32_t>, BlockHash> by_block_;
};

/// Returns the fault of a mesh that is not closed, as text. Returns nullopt if each edge has equally many triangles in
/// both directions. Equal positions are one vertex.
std::optional<std::string> open_edges(const std::vector<Vec3i64>& positions,
                                      const std::vector<LatticeMesh::Triangle>& triangles);

}  // namespace gigabake
