/// Large triangle lists as several primitives, for those who take them one after the other (PrimitiveSink).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/source/mesh.h"
#include "format/source/source.h"

namespace gigabake {

/// Returns how many triangles a reader collects before it hands over a part: fewer than most_part_triangles if the
/// memory limit is small, since several parts are held at the same time.
std::uint64_t part_triangles();

/// Is a list handed over in parts? A part has at most most_part_triangles triangles, in the list's order, and of the
/// vertices those alone that they use.
constexpr bool comes_in_parts(std::uint64_t triangles, std::uint64_t vertices) {
  return triangles > most_part_triangles || vertices > 3 * most_part_triangles;
}

/// The vertices that some corners use, each once, ascending.
/// Cost  bytes_of_64 for every 64 vertices between the first and the last of them, and four bytes for each of them.
class UsedVertices {
 public:
  static constexpr std::uint64_t bytes_of_64 = 12;

  explicit UsedVertices(std::span<const std::uint32_t> corners);

  const std::vector<std::uint32_t>& ascending() const { return ascending_; }
  /// Makes the corners' numbers places in ascending().
  void renumber(std::span<std::uint32_t> corners) const;

 private:
  std::uint32_t first_ = 0;
  std::vector<std::uint64_t> is_used_;  ///< a bit a vertex, from first_ on
  std::vector<std::uint32_t> before_;   ///< used vertices before each word of is_used_
  std::vector<std::uint32_t> ascending_;
};

/// Returns the primitive of some triangles of `whole`, with the vertices that they use. `vertices` becomes the number
/// of each vertex in `whole`.
Primitive with_corners(const Primitive& whole, std::vector<std::uint32_t>&& index,
                       std::vector<std::uint32_t>& vertices);

/// What is kept of a primitive that was handed over.
Primitive without_lists(const Primitive& primitive);

/// Hands over what was read whole, and leaves of it what a sink leaves. Cost  One part beside the mesh.
void hand_over_parts(TileMesh& mesh, const PrimitiveSink& sink);

}  // namespace gigabake
