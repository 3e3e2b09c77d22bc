/// Large triangle lists split into several primitives, for a PrimitiveSink that receives them one after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/source/mesh.h"
#include "format/source/source.h"

namespace gigabake {

/// Returns the number of triangles that a reader collects before it passes on a part. It is less than
/// max_part_triangles if the memory limit is small, since several parts are in memory at the same time.
std::uint64_t part_triangles();

/// Returns whether a list is passed on in parts. A part has at most max_part_triangles triangles, in the list's order,
/// and only the vertices that these triangles use.
constexpr bool is_split(std::uint64_t triangles, std::uint64_t vertices) {
  return triangles > max_part_triangles || vertices > 3 * max_part_triangles;
}

/// The set of vertices that some triangle corners use, in ascending order.
/// Cost    Memory: bytes_of_64 for every 64 vertices between the first and the last used vertex, and four bytes for
///         each used vertex.
class UsedVertices {
 public:
  static constexpr std::uint64_t bytes_of_64 = 12;

  explicit UsedVertices(std::span<const std::uint32_t> corners);

  const std::vector<std::uint32_t>& ascending() const { return ascending_; }
  /// Replaces each corner's vertex number by its index in ascending().
  void renumber(std::span<std::uint32_t> corners) const;

 private:
  std::uint32_t first_ = 0;
  std::vector<std::uint64_t> is_used_;  ///< a bit per vertex, from first_ on
  std::vector<std::uint32_t> before_;   ///< number of used vertices before each word of is_used_
  std::vector<std::uint32_t> ascending_;
};

/// Returns a primitive with the triangles `index` of `whole` and only the vertices that they use. Sets vertices[v] to
/// the number in `whole` of vertex v of the result.
Primitive with_corners(const Primitive& whole, std::vector<std::uint32_t>&& index,
                       std::vector<std::uint32_t>& vertices);

/// Returns a copy with only `material`, `position_step`, `shares_uv` and `voxel_class`. TileMesh keeps this copy after
/// the primitive has been passed to a sink.
Primitive without_lists(const Primitive& primitive);

/// Passes the primitives of a complete mesh to the sink, large primitives in parts. The mesh keeps without_lists() of
/// each part.
/// Cost    Memory of one part in addition to the mesh.
void pass_on_parts(TileMesh& mesh, const PrimitiveSink& sink);

}  // namespace gigabake
