/// The baseline of `bench accuracy --flight`: the triangles of a source, with one level per part.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/flight/mesh_levels.h"

namespace gigabake::bench {

/// The triangles that one camera needs.
struct MeshChoice {
  std::vector<Span<const std::uint32_t>> indices;  ///< one entry per part, for SourceTriangles::with_indices()
  std::uint64_t triangles = 0;
  /// Bytes of the indices (4 each) and of the vertices that they use: position 12, coordinates of the texture 8,
  /// colour 4. Without textures.
  std::uint64_t bytes = 0;
};

class MeshBaseline {
 public:
  /// Makes the levels of all parts. A part is a primitive of a tile; instances are separate parts. Borrows `source`.
  /// Cost    The triangles of all levels: at most twice the source's indices.
  /// Errors  See make_mesh_levels().
  MeshBaseline(const SourceTriangles& source, int threads);

  /// Returns the coarsest level of each part whose error is at most `max_pixels`. Parts behind the eye have no
  /// triangles. The result borrows the levels.
  MeshChoice choose(const kernels::CastCamera& camera, double max_pixels) const;

  /// Returns the number of triangles of the source.
  std::uint64_t source_triangles() const;

 private:
  const SourceTriangles& source_;
  std::vector<MeshLevels> parts_;
};

}  // namespace gigabake::bench
