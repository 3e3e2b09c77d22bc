#include "format/source/gltf/material.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/math/srgb.h"
#include "format/source/gltf/texture_info.h"

namespace gigabake {
namespace {

constexpr const char* gloss_extension = "KHR_materials_pbrSpecularGlossiness";
constexpr const char* unlit_extension = "KHR_materials_unlit";
constexpr const char* techniques_extension = "KHR_techniques_webgl";

float clamp01(double v) { return v >= 0 ? float(std::min(v, 1.0)) : 0.0f; }

std::string name_of(const tinygltf::Model& model, int material) {
  const std::string& name = model.materials[std::size_t(material)].name;
  return name.empty() ? "materials[" + std::to_string(material) + "]" : in_quotes(name);
}

const tinygltf::Value* extension_of(const tinygltf::Material& m, const char* name) {
  const auto at = m.extensions.find(name);
  return at == m.extensions.end() ? nullptr : &at->second;
}

void use_base_texture(const tinygltf::Model& model, const TextureInfo& info, SourceMaterial& out,
                      SourceWarnings& warnings) {
  use_texture(model, info, out.material.texture, out.texture, warnings);
}

/// Uses the extension's colour in place of the metallic-roughness base colour.
void use_specular_glossiness(const tinygltf::Model& model, const tinygltf::Value& gloss, SourceMaterial& out,
                             SourceWarnings& warnings) {
  if (gloss.Has("diffuseFactor") && gloss.Get("diffuseFactor").ArrayLen() == 4)
    for (std::size_t c = 0; c < 4; ++c)
      out.material.base_color[c] = clamp01(gloss.Get("diffuseFactor").Get(c).GetNumberAsDouble());
  if (gloss.Has("diffuseTexture")) use_base_texture(model, texture_info(gloss.Get("diffuseTexture")), out, warnings);
}

/// Returns the first colour or texture of a shader with "diffuse" in the name of the value; null if there is none.
const tinygltf::Value* diffuse_value(const tinygltf::Value& technique) {
  if (!technique.IsObject() || !technique.Has("values")) return nullptr;
  const tinygltf::Value& values = technique.Get("values");
  for (const std::string& name : values.IsObject() ? values.Keys() : std::vector<std::string>()) {
    std::string lower = name;
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    const tinygltf::Value& value = values.Get(name);
    const bool is_colour = value.IsArray() && (value.ArrayLen() == 3 || value.ArrayLen() == 4);
    if (lower.find("diffuse") != std::string::npos && (is_colour || (value.IsObject() && value.Has("index"))))
      return &value;
  }
  return nullptr;
}

/// Uses the colour of a glTF 1.0 shader. The colours of glTF 1.0 shaders are sRGB.
void use_technique(const std::filesystem::path& file, const tinygltf::Model& model, int material,
                   const tinygltf::Value& technique, SourceMaterial& out, SourceWarnings& warnings) {
  const tinygltf::Value* diffuse = diffuse_value(technique);
  if (diffuse == nullptr)
    throw InputError(file, name_of(model, material),
                     std::string("only the extension ") + techniques_extension +
                         " describes the material, by a shader without a diffuse colour; convert it to a PBR material");
  if (diffuse->IsObject()) return use_base_texture(model, texture_info(*diffuse), out, warnings);
  for (std::size_t c = 0; c < diffuse->ArrayLen(); ++c) {
    const float value = diffuse->Get(c).IsNumber() ? clamp01(diffuse->Get(c).GetNumberAsDouble()) : 1.0f;
    out.material.base_color[c] = c < 3 ? float(linear_from_srgb(value)) : value;
  }
}

std::array<float, 3> emission_of(const tinygltf::Material& m) {
  std::array<float, 3> out{};
  const tinygltf::Value* strength = extension_of(m, "KHR_materials_emissive_strength");
  const float scale = strength == nullptr ? 1.0f : number_or(*strength, "emissiveStrength", 1);
  for (std::size_t c = 0; c < 3 && m.emissiveFactor.size() == 3; ++c) out[c] = clamp01(m.emissiveFactor[c] * scale);
  return out;
}

/// Returns whether the material is visible only by the light that it emits. A base texture that is needed for its alpha
/// counts as visible.
bool is_only_emissive(const tinygltf::Material& m, const Material& read) {
  const std::array<float, 3> emission = emission_of(m);
  const bool is_black =
      std::all_of(read.base_color.begin(), read.base_color.begin() + 3, [](float c) { return c == 0; });
  const bool needs_texture = read.texture.image >= 0 && read.alpha_mode != AlphaMode::opaque;
  return is_black && !needs_texture && *std::max_element(emission.begin(), emission.end()) > 0;
}

void use_emission(const tinygltf::Model& model, const tinygltf::Material& m, SourceMaterial& out,
                  SourceWarnings& warnings) {
  Material& material = out.material;
  const bool passes = material.alpha_mode == AlphaMode::mask ? material.base_color[3] >= material.alpha_cutoff
                                                             : material.base_color[3] == 1;
  if (passes) material.alpha_mode = AlphaMode::opaque;  // an emissive texture's alpha has no meaning
  const std::array<float, 3> emission = emission_of(m);
  std::copy(emission.begin(), emission.end(), material.base_color.begin());
  material.texture = {};
  material.unlit = true;
  out.texture.fault.clear();
  out.texture.uv_transform = TextureSource().uv_transform;
  tinygltf::TextureInfo info;
  info.index = m.emissiveTexture.index, info.texCoord = m.emissiveTexture.texCoord;
  info.extensions = m.emissiveTexture.extensions;
  if (passes || info.index < 0) use_base_texture(model, texture_info(info), out, warnings);
}

/// Returns the first extension that may describe a base colour and is not read; empty if there is none.
std::string unread_description(const tinygltf::Material& m) {
  for (const auto& [name, value] : m.extensions)
    if (!name.starts_with("KHR_materials_") || name == "KHR_materials_common") return name;
  return {};
}

/// Reads the material's colour.
void use_colour(const std::filesystem::path& file, const tinygltf::Model& model, int material, SourceMaterial& out,
                SourceWarnings& warnings) {
  const tinygltf::Material& m = model.materials[std::size_t(material)];
  const tinygltf::PbrMetallicRoughness& pbr = m.pbrMetallicRoughness;
  if (const tinygltf::Value* gloss = extension_of(m, gloss_extension))
    return use_specular_glossiness(model, *gloss, out, warnings);
  const bool has_core = !m.values.empty();
  const bool has_core_colour = m.values.contains("baseColorFactor") || m.values.contains("baseColorTexture");
  const tinygltf::Value* technique = extension_of(m, techniques_extension);
  if (technique != nullptr && (!has_core || (!has_core_colour && diffuse_value(*technique) != nullptr)))
    return use_technique(file, model, material, *technique, out, warnings);
  if (const std::string unread = unread_description(m); !has_core && !unread.empty())
    warnings.count("materials that only an unsupported extension describes, taken as white",
                   name_of(model, material) + " (" + unread + ")");
  for (std::size_t c = 0; c < 4 && pbr.baseColorFactor.size() == 4; ++c)
    out.material.base_color[c] = clamp01(pbr.baseColorFactor[c]);
  use_base_texture(model, texture_info(pbr.baseColorTexture), out, warnings);
}

/// Reads the normal map. An unlit material has none, by KHR_materials_unlit.
void use_normal_map(const tinygltf::Model& model, int material, SourceMaterial& out, SourceWarnings& warnings) {
  const tinygltf::NormalTextureInfo& from = model.materials[std::size_t(material)].normalTexture;
  if (from.index < 0 || out.material.unlit) return;
  tinygltf::TextureInfo info;
  info.index = from.index, info.texCoord = from.texCoord, info.extensions = from.extensions;
  NormalMap& map = out.material.normal_map;
  use_texture(model, texture_info(info), map.texture, out.normal_map, warnings);
  if (std::fabs(from.scale) <= double(std::numeric_limits<float>::max())) {
    map.scale = float(from.scale);
    return;
  }
  warnings.count("scales of normal maps that are not finite, taken as 1",
                 "materials[" + std::to_string(material) + "].normalTexture.scale");
}

}  // namespace

SourceMaterial source_material(const std::filesystem::path& file, const tinygltf::Model& model, int material,
                               SourceWarnings& warnings) {
  const tinygltf::Material& m = model.materials[std::size_t(material)];
  SourceMaterial out;
  use_colour(file, model, material, out, warnings);
  out.material.alpha_mode = value_named<AlphaMode>(m.alphaMode).value();  // check.cpp refuses other names
  out.material.alpha_cutoff = std::isfinite(m.alphaCutoff) ? float(m.alphaCutoff) : 0.5f;
  out.material.double_sided = m.doubleSided;
  out.material.unlit = m.extensions.contains(unlit_extension);
  if (is_only_emissive(m, out.material)) use_emission(model, m, out, warnings);
  use_normal_map(model, material, out, warnings);
  return out;
}

}  // namespace gigabake
