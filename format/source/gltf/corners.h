/// Vertices of a glTF primitive in the order in which they are drawn, for lists, strips and fans with or without
/// indices.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "format/source/gltf/accessor.h"

namespace gigabake {

/// Reader of a primitive's corners. It keeps none of them in memory.
class Corners {
 public:
  /// `where` is the path of the primitive, for messages. `vertices` is the number of its vertices, which limits
  /// indices. `file`, `where` and `document` must outlive the object.
  /// Errors  InputError: indices are not unsigned integers; the length of a list of triangles is no multiple of 3.
  Corners(const std::filesystem::path& file, const GltfDocument& document, const tinygltf::Primitive& primitive,
          const std::string& where, std::uint64_t vertices);

  /// Returns the mode by glTF's numbers: 0 points, 1 to 3 lines, 4 to 6 triangles.
  int mode() const { return mode_; }
  /// Returns the number of drawn vertices: points, ends of lines, or corners of a list, a strip or a fan.
  std::uint64_t drawn() const { return drawn_; }
  /// Range  mode() ≥ 4.
  std::uint64_t triangles() const;

  /// Returns three corners per triangle for `count` triangles. All triangles have the winding of a triangle list.
  /// Errors  InputError: an index exceeds the vertices.
  std::vector<std::uint32_t> of_triangles(std::uint64_t first, std::uint64_t count) const;
  /// Checks all indices.
  /// Errors  InputError like of_triangles().
  void check() const;

 private:
  std::vector<std::uint32_t> in_order(std::uint64_t first, std::uint64_t count) const;

  const std::filesystem::path& file_;
  const std::string& where_;
  std::uint64_t vertices_, drawn_;
  int mode_;
  std::optional<AccessorItems> indices_;
};

}  // namespace gigabake
