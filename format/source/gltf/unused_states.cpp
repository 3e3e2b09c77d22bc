// count_unused_states(): features of a glTF document that have no effect on voxels.
#include <algorithm>
#include <set>

#include "core/base/error.h"
#include "format/source/gltf/material.h"

namespace gigabake {
namespace {

/// Returns whether the extension is read or describes nothing visible.
bool is_read_or_invisible(const std::string& extension) {
  static const std::set<std::string> known{"KHR_texture_transform",
                                           "KHR_materials_unlit",
                                           "KHR_materials_pbrSpecularGlossiness",
                                           "KHR_materials_emissive_strength",
                                           "KHR_mesh_quantization",
                                           "KHR_draco_mesh_compression",
                                           "KHR_node_visibility",
                                           "KHR_techniques_webgl",
                                           "EXT_meshopt_compression",
                                           "EXT_texture_webp",
                                           "EXT_mesh_gpu_instancing",
                                           "CESIUM_RTC",
                                           "EXT_mesh_features",
                                           "EXT_structural_metadata",
                                           "EXT_instance_features",
                                           "EXT_feature_metadata",
                                           "CESIUM_primitive_outline",
                                           "KHR_xmp_json_ld",
                                           "KHR_lights_punctual"};
  return known.contains(extension);
}

void count_textures(const tinygltf::Material& m, const std::string& where, SourceWarnings& warnings) {
  const auto count = [&](int index, const char* name) {
    if (index >= 0) warnings.count("textures other than base colours and normal maps, not used", where + "." + name);
  };
  count(m.occlusionTexture.index, "occlusionTexture");
  count(m.pbrMetallicRoughness.metallicRoughnessTexture.index, "pbrMetallicRoughness.metallicRoughnessTexture");
  const auto& base = m.pbrMetallicRoughness.baseColorFactor;
  const bool is_black = base.size() == 4 && base[0] <= 0 && base[1] <= 0 && base[2] <= 0;
  if (!is_black) count(m.emissiveTexture.index, "emissiveTexture");
}

}  // namespace

void count_unused_states(const tinygltf::Model& model, SourceWarnings& warnings) {
  for (const std::string& extension : model.extensionsUsed)
    if (!is_read_or_invisible(extension)) warnings.count("extensions that are not read", in_quotes(extension));
  for (std::size_t i = 0; i < model.materials.size(); ++i)
    count_textures(model.materials[i], "materials[" + std::to_string(i) + "]", warnings);
  for (std::size_t i = 0; i < model.animations.size(); ++i)
    warnings.count("animations, not played", "animations[" + std::to_string(i) + "]");
  for (std::size_t i = 0; i < model.skins.size(); ++i)
    warnings.count("skins, taken in their rest pose", "skins[" + std::to_string(i) + "]");
  for (std::size_t i = 0; i < model.meshes.size(); ++i) {
    const auto& primitives = model.meshes[i].primitives;
    if (std::any_of(primitives.begin(), primitives.end(), [](const auto& p) { return !p.targets.empty(); }))
      warnings.count("meshes with morph targets, which are not applied", "meshes[" + std::to_string(i) + "]");
  }
}

}  // namespace gigabake
