/// Conversion of the vertices of a glTF primitive to the lists of a Primitive.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "format/source/classes/feature_ids.h"
#include "format/source/gltf/accessor.h"
#include "format/source/gltf/corners.h"
#include "format/source/gltf/material.h"
#include "format/source/mesh.h"

namespace gigabake {

/// Bytes that a corner needs while it is read.
inline constexpr std::uint64_t corner_bytes = 8;

/// Readers of the vertices of a primitive, for all vertices or for the vertices of a part.
struct VertexValues {
  AccessorItems position;
  int material = 0;
  std::optional<AccessorItems> colour = {}, uv = {}, normal = {}, normal_uv = {}, tangent = {};
  std::optional<FeatureIds> ids = {};  ///< classes are taken from them
  bool shares_uv = false;              ///< `uv` has the coordinates of the normal map

  /// Returns the bytes that a vertex needs while it is read.
  std::uint64_t bytes_of_vertex() const;
};

/// A function that claims memory for a number of items before they are allocated. It may throw, and must be
/// thread-safe.
using ClaimItems = std::function<void(std::uint64_t items, std::uint64_t item_bytes, const char* what)>;

/// Returns the normals in the encoding of a Primitive. `xyz` has three floats per normal.
std::vector<VertexNormal> vertex_normals(const std::vector<float>& xyz);
/// Returns the tangents in the encoding of a Primitive. `xyzw` has four floats per tangent. A tangent whose fourth
/// number is neither positive nor negative has no direction.
std::vector<VertexTangent> vertex_tangents(const std::vector<float>& xyzw);

/// Returns the lists of a primitive with all triangles and all vertices. The caller sets the other members.
Primitive read_whole(const Corners& corners, const VertexValues& values, const SourceMaterial& material);

/// Returns the lists of a primitive with up to max_part_triangles triangles from `first` on, and the vertices that they
/// use. Thread-safe.
/// Errors  The errors of Corners::of_triangles(), AccessorItems and `claim`.
Primitive read_part(const Corners& corners, std::uint64_t first, const VertexValues& values,
                    const SourceMaterial& material, const ClaimItems& claim);

}  // namespace gigabake
