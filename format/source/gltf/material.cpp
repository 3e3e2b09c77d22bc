#include "format/source/gltf/material.h"

#include <algorithm>
#include <cmath>

#include "format/source/image/codecs.h"
#include "lattice/error.h"

namespace gigabake {
namespace {

float number_or(const tinygltf::Value& object, const char* key, float otherwise) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsNumber()) return otherwise;
  return float(object.Get(key).GetNumberAsDouble());
}

std::array<float, 2> pair_or(const tinygltf::Value& object, const char* key, std::array<float, 2> otherwise) {
  if (!object.IsObject() || !object.Has(key) || object.Get(key).ArrayLen() != 2) return otherwise;
  const tinygltf::Value& v = object.Get(key);
  if (!v.Get(0).IsNumber() || !v.Get(1).IsNumber()) return otherwise;
  return {float(v.Get(0).GetNumberAsDouble()), float(v.Get(1).GetNumberAsDouble())};
}

float clamp01(double v) { return v >= 0 ? float(std::min(v, 1.0)) : 0.0f; }

/// gl: as glTF writes it, one of OpenGL's numbers.
Wrap wrap_of(const std::filesystem::path& file, int sampler, const char* key, int gl) {
  switch (gl) {
    case TINYGLTF_TEXTURE_WRAP_REPEAT:
      return Wrap::repeat;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return Wrap::mirrored_repeat;
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return Wrap::clamp_to_edge;
  }
  throw InputError(
      file, "samplers[" + std::to_string(sampler) + "]." + key,
      "expected 10497 (repeat), 33648 (mirrored repeat) or 33071 (clamp to edge), got " + std::to_string(gl));
}

/// Source  KHR_texture_transform: translation · rotation · scale.
void apply_texture_transform(const tinygltf::Value& t, SourceMaterial& out) {
  const auto offset = pair_or(t, "offset", {0, 0}), scale = pair_or(t, "scale", {1, 1});
  const float rotation = number_or(t, "rotation", 0), c = std::cos(rotation), s = std::sin(rotation);
  out.uv_transform = {{{c * scale[0], -s * scale[1], offset[0]}, {s * scale[0], c * scale[1], offset[1]}}};
  out.texcoord_set = int(number_or(t, "texCoord", float(out.texcoord_set)));
}

void use_texture(const std::filesystem::path& file, const tinygltf::Model& model, int index, SourceMaterial& out) {
  const tinygltf::Texture& texture = model.textures[std::size_t(index)];
  const std::string where = "textures[" + std::to_string(index) + "].source";
  TextureUse& use = out.material.texture;
  use.image = texture.source;
  // Where there is a plain image too, it is taken: so no texel depends on what gigabake was built with.
  if (const auto webp = texture.extensions.find("EXT_texture_webp"); use.image < 0 && webp != texture.extensions.end())
    use.image = webp->second.Has("source") ? webp->second.Get("source").GetNumberAsInt() : -1;
  if (use.image < 0 && texture.extensions.contains("KHR_texture_basisu"))
    throw InputError(file, where, *missing_codec("KHR_texture_basisu"));
  if (use.image < 0) throw InputError(file, where, "is missing: expected a PNG, JPEG or WebP image");
  if (texture.sampler < 0) return;
  const tinygltf::Sampler& sampler = model.samplers[std::size_t(texture.sampler)];
  use.wrap_s = wrap_of(file, texture.sampler, "wrapS", sampler.wrapS);
  use.wrap_t = wrap_of(file, texture.sampler, "wrapT", sampler.wrapT);
  use.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
}

/// The extension replaces the metallic-roughness base colour.
void use_specular_glossiness(const std::filesystem::path& file, const tinygltf::Model& model,
                             const tinygltf::Value& gloss, SourceMaterial& out) {
  out.material.base_color = {1, 1, 1, 1};
  out.material.texture = {};
  if (gloss.Has("diffuseFactor") && gloss.Get("diffuseFactor").ArrayLen() == 4)
    for (std::size_t c = 0; c < 4; ++c)
      out.material.base_color[c] = clamp01(gloss.Get("diffuseFactor").Get(c).GetNumberAsDouble());
  if (!gloss.Has("diffuseTexture")) return;
  const tinygltf::Value& use = gloss.Get("diffuseTexture");
  out.texcoord_set = int(number_or(use, "texCoord", 0));
  if (use.Has("extensions") && use.Get("extensions").Has("KHR_texture_transform"))
    apply_texture_transform(use.Get("extensions").Get("KHR_texture_transform"), out);
  use_texture(file, model, use.Get("index").GetNumberAsInt(), out);
}

}  // namespace

SourceMaterial source_material(const std::filesystem::path& file, const tinygltf::Model& model, int material) {
  const tinygltf::Material& m = model.materials[std::size_t(material)];
  SourceMaterial out;
  const tinygltf::PbrMetallicRoughness& pbr = m.pbrMetallicRoughness;
  for (std::size_t c = 0; c < 4 && pbr.baseColorFactor.size() == 4; ++c)
    out.material.base_color[c] = clamp01(pbr.baseColorFactor[c]);
  if (pbr.baseColorTexture.index >= 0) {
    out.texcoord_set = pbr.baseColorTexture.texCoord;
    const auto transform = pbr.baseColorTexture.extensions.find("KHR_texture_transform");
    if (transform != pbr.baseColorTexture.extensions.end()) apply_texture_transform(transform->second, out);
  }
  const auto gloss = m.extensions.find("KHR_materials_pbrSpecularGlossiness");
  if (gloss != m.extensions.end())
    use_specular_glossiness(file, model, gloss->second, out);
  else if (pbr.baseColorTexture.index >= 0)
    use_texture(file, model, pbr.baseColorTexture.index, out);
  out.material.alpha_mode = value_named<AlphaMode>(m.alphaMode).value();  // check.cpp refuses other names
  out.material.alpha_cutoff = std::isfinite(m.alphaCutoff) ? float(m.alphaCutoff) : 0.5f;
  out.material.double_sided = m.doubleSided;
  out.material.unlit = m.extensions.contains("KHR_materials_unlit");
  return out;
}

}  // namespace gigabake
