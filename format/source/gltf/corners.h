/// Which vertices a glTF primitive draws, in which order: with indices or without, as a list, a strip or a fan.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "format/source/gltf/accessor.h"

namespace gigabake {

/// Nothing of them is held.
class Corners {
 public:
  /// where, vertices: the primitive's, for messages and as bound of its indices; all outlive this.
  /// Errors  InputError: indices that are no unsigned integers, a list of triangles with corners left over.
  Corners(const std::filesystem::path& file, const GltfDocument& document, const tinygltf::Primitive& primitive,
          const std::string& where, std::uint64_t vertices);

  /// As glTF names it: 0 points, 1 to 3 lines, 4 to 6 triangles.
  int mode() const { return mode_; }
  /// What is drawn, each corner once: points, ends of lines, corners of a list, a strip or a fan.
  std::uint64_t drawn() const { return drawn_; }
  /// Range  mode() ≥ 4.
  std::uint64_t triangles() const;

  /// Three corners for each of these triangles, as the winding of a list has them.
  /// Errors  InputError: an index that is none of the vertices.
  std::vector<std::uint32_t> of_triangles(std::uint64_t first, std::uint64_t count) const;
  /// Errors  InputError: as of_triangles(), of any index.
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
