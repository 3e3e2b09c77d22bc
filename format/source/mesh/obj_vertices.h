/// The vertices, texture coordinates and normals of an OBJ, and the corners of its faces, which refer to them by index.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/memory_limit.h"
#include "core/math/octahedral.h"
#include "format/source/mesh/obj_lines.h"
#include "format/source/source_warning.h"

namespace gigabake {

class ObjVertices {
 public:
  /// `claim` counts all allocated memory; `file` and `claim` must outlive the object.
  explicit ObjVertices(const std::filesystem::path& file, MemoryClaim& claim) : file_(file), claim_(claim) {}

  /// Reserves memory for all vertices, texture coordinates and normals. Without reserved memory, normals are checked
  /// and not stored.
  /// Errors  InputError: a number is not below 2^32 - 1, or the memory exceeds the limit.
  void reserve(std::uint64_t positions, std::uint64_t uvs, std::uint64_t normals);
  /// Adds the vertex, texture coordinates or normal of a line `v`, `vt` or `vn`. If numbers are missing, a vertex
  /// becomes NaN, texture coordinates become 0 and a normal has no direction, so that later indices remain valid.
  void take(const ObjLine& line, SourceWarnings& warnings);

  std::size_t positions() const { return position_.size(); }
  std::size_t uvs() const { return uv_.size(); }
  const std::vector<std::array<double, 3>>& position() const { return position_; }
  const std::array<float, 2>& uv(std::uint32_t i) const { return uv_[i]; }
  bool has_normals() const { return !normal_.empty(); }
  const VertexNormal& normal(std::uint32_t i) const { return normal_[i]; }
  /// Returns whether the vertex has a colour.
  bool has_colour(std::uint32_t i) const { return i < colour_.size() && colour_[i][3] == opaque; }
  bool has_colours() const { return !colour_.empty(); }
  /// Returns the linear colour of the vertex; 65535 = 1.
  const std::array<std::uint16_t, 4>& colour(std::uint32_t i) const { return colour_[i]; }

 private:
  static constexpr std::uint16_t opaque = 65535;

  void take_position(const ObjLine& line, SourceWarnings& warnings);
  void take_normal(const ObjLine& line, SourceWarnings& warnings);
  void expect_capacity(bool is_there, const ObjLine& line) const;

  const std::filesystem::path& file_;
  MemoryClaim& claim_;
  std::vector<std::array<double, 3>> position_;
  std::vector<std::array<std::uint16_t, 4>> colour_;  ///< alpha is not `opaque` if the vertex has no colour
  std::vector<std::array<float, 2>> uv_;
  std::vector<VertexNormal> normal_;
};

struct ObjCorner {
  static constexpr std::uint32_t none = ~std::uint32_t(0);
  std::uint32_t position = 0, uv = none, normal = none;

  friend bool operator==(const ObjCorner&, const ObjCorner&) = default;
};

/// Numbers of vertices, texture coordinates and normals before a face, and in the whole file. Negative indices count
/// back from the numbers before the face.
struct ObjIndexRange {
  std::uint64_t positions = 0, uvs = 0, normals = 0, all_positions = 0, all_uvs = 0, all_normals = 0;
};

enum class ObjFaceFault : std::uint8_t { none, no_index, no_vertex, too_many_corners };

/// Numbers of indices in a face that refer to missing items.
struct ObjBadIndices {
  std::uint64_t uvs = 0, normals = 0;
};

/// Reads the corners of a line `f`, up to a comment. Indices of missing texture coordinates and normals are counted in
/// `bad`; such corners have none.
ObjFaceFault read_obj_corners(std::string_view text, const ObjIndexRange& range, std::vector<ObjCorner>& corners,
                              ObjBadIndices& bad);

}  // namespace gigabake
