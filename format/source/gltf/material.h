/// glTF materials reduced to the properties that a bake uses: base colour, alpha, texture, normal map.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <tiny_gltf.h>

#include "format/source/mesh.h"
#include "format/source/source_warning.h"

namespace gigabake {

/// The source of a texture's coordinates.
struct TextureSource {
  int texcoord_set = 0;
  /// KHR_texture_transform: u' = row 0 · (u, v, 1), v' = row 1 · (u, v, 1).
  std::array<std::array<float, 3>, 2> uv_transform{{{1, 0, 0}, {0, 1, 0}}};
  std::string fault = {};  ///< why the texture has no image; else empty

  bool has_coordinates_of(const TextureSource& other) const {
    return texcoord_set == other.texcoord_set && uv_transform == other.uv_transform;
  }
};

/// A material and the sources of its texture coordinates.
struct SourceMaterial {
  Material material;
  TextureSource texture, normal_map;
};

/// Returns a material of a checked document. Its colour is the diffuse colour of KHR_materials_pbrSpecularGlossiness,
/// else the base colour of core glTF, else the diffuse colour of KHR_techniques_webgl. If this colour is black, the
/// emitted colour is used, because files without KHR_materials_unlit often describe unlit materials by emission.
/// Errors  InputError: only KHR_techniques_webgl describes the material, and it has no diffuse colour.
SourceMaterial source_material(const std::filesystem::path& file, const tinygltf::Model& model, int material,
                               SourceWarnings& warnings);

/// Counts features of a document that no bake uses: extensions, animations, textures that are not colours.
void count_unused_states(const tinygltf::Model& model, SourceWarnings& warnings);

}  // namespace gigabake
