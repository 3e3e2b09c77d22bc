/// glTF materials as the bake sees them: base colour, alpha, texture.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <tiny_gltf.h>

#include "format/source/mesh.h"
#include "format/source/source_warning.h"

namespace gigabake {

/// A material and where its texture coordinates come from.
struct SourceMaterial {
  Material material;
  int texcoord_set = 0;
  /// KHR_texture_transform: u' = row 0 · (u, v, 1), v' = row 1 · (u, v, 1).
  std::array<std::array<float, 3>, 2> uv_transform{{{1, 0, 0}, {0, 1, 0}}};
  std::string texture_fault = {};  ///< why a texture that the material names has no image; empty: it has, or names none
};

/// Returns a material of a checked document. Its colour is that of the core's base colour or of
/// KHR_materials_pbrSpecularGlossiness; of KHR_techniques_webgl where neither is; and what it emits where the base
/// colour is black, as unlit materials were written before an extension for them existed.
/// Errors  InputError: only KHR_techniques_webgl describes the material, and names no diffuse colour.
SourceMaterial source_material(const std::filesystem::path& file, const tinygltf::Model& model, int material,
                               SourceWarnings& warnings);

/// Counts what a document states and no bake uses: extensions, animations, textures that are not colours.
void count_unused_states(const tinygltf::Model& model, SourceWarnings& warnings);

}  // namespace gigabake
