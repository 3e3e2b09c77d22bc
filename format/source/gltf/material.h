/// glTF materials as the bake sees them: base colour, alpha, texture.
#pragma once

#include <array>
#include <filesystem>
#include <tiny_gltf.h>

#include "format/source/mesh.h"

namespace gigabake {

/// A material and where its texture coordinates come from.
struct SourceMaterial {
  Material material;
  int texcoord_set = 0;
  /// KHR_texture_transform: u' = row 0 · (u, v, 1), v' = row 1 · (u, v, 1).
  std::array<std::array<float, 3>, 2> uv_transform{{{1, 0, 0}, {0, 1, 0}}};
};

/// Errors  InputError: a base colour texture without a PNG or JPEG source.
SourceMaterial source_material(const std::filesystem::path& file, const tinygltf::Model& model, int material);

}  // namespace gigabake
