/// Triangles of a PLY while they are collected.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "format/source/mesh.h"
#include "format/source/mesh/ply_layout.h"

namespace gigabake {

/// The triangles of one texture, or all triangles without texture coordinates.
struct PlyPart {
  /// Bytes of a vertex in `primitive` and `position_of`, and bytes of a corner.
  static constexpr std::uint64_t vertex_bytes = 12 + 8 + 8 + 4 + 4, corner_bytes = 4;

  Primitive primitive;
  std::vector<std::uint32_t> position_of;  ///< index of the position per vertex
  std::vector<std::uint32_t> vertex_of;    ///< vertex per position; empty if corners are not shared

  std::uint64_t bytes() const { return position_of.size() * vertex_bytes + primitive.index.size() * corner_bytes; }
};

struct PlyFace {
  std::vector<std::uint32_t> corners;
  std::vector<float> uv;  ///< two values per corner, or empty
  int texture = 0;
  std::optional<PlyColour::Rgba> colour = {};
  bool is_lost = false;  ///< an index is invalid, or there are too many corners
};

}  // namespace gigabake
