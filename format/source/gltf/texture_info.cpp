#include "format/source/gltf/texture_info.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/pluralize.h"
#include "format/source/image/codecs.h"

namespace gigabake {
namespace {

constexpr const char* transform_extension = "KHR_texture_transform";
/// OpenGL's numbers of wrap modes that glTF does not have.
constexpr int gl_clamp = 10496, gl_clamp_to_border = 33069;

std::array<float, 2> pair_or(const tinygltf::Value& object, const char* key, std::array<float, 2> otherwise) {
  if (!object.IsObject() || !object.Has(key) || object.Get(key).ArrayLen() != 2) return otherwise;
  const tinygltf::Value& v = object.Get(key);
  if (!v.Get(0).IsNumber() || !v.Get(1).IsNumber()) return otherwise;
  return {float(v.Get(0).GetNumberAsDouble()), float(v.Get(1).GetNumberAsDouble())};
}

/// Applies the transform of the extension.
/// Source  KHR_texture_transform: translation · rotation · scale, where "rotation" turns texture coordinates
///         counter-clockwise as seen on the image. The image's v points down, so (1, 0) turns towards (0, -1). For a
///         rotation r, u' = u cos r + v sin r and v' = v cos r - u sin r. The matrix of the extension's text turns the
///         other way (KhronosGroup/glTF#1563); the Khronos sample viewer and its TextureTransformTest turn as this
///         function does.
void apply_texture_transform(const tinygltf::Value& t, TextureSource& out) {
  const auto offset = pair_or(t, "offset", {0, 0}), scale = pair_or(t, "scale", {1, 1});
  const float rotation = number_or(t, "rotation", 0), c = std::cos(rotation), s = std::sin(rotation);
  out.uv_transform = {{{c * scale[0], s * scale[1], offset[0]}, {-s * scale[0], c * scale[1], offset[1]}}};
  out.texcoord_set = index_or(t, "texCoord", out.texcoord_set);
}

/// Returns a wrap mode. `gl` is OpenGL's number of the wrap mode, as glTF stores it.
Wrap wrap_of(int sampler, const char* key, int gl, SourceWarnings& warnings) {
  if (gl == TINYGLTF_TEXTURE_WRAP_REPEAT) return Wrap::repeat;
  if (gl == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return Wrap::mirrored_repeat;
  if (gl == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::clamp_to_edge;
  const bool clamps = gl == gl_clamp || gl == gl_clamp_to_border;
  warnings.count(clamps ? "wrap modes that glTF does not define, read as clamp to edge"
                        : "wrap modes that glTF does not define, read as repeat",
                 "samplers[" + std::to_string(sampler) + "]." + key + " " + std::to_string(gl));
  return clamps ? Wrap::clamp_to_edge : Wrap::repeat;
}

/// Returns the index of a texture's image. Prefers a PNG or JPEG to WebP, so that no texel depends on the build
/// options.
int image_of(const tinygltf::Texture& texture) {
  const auto webp = texture.extensions.find("EXT_texture_webp");
  if (texture.source >= 0 || webp == texture.extensions.end()) return texture.source;
  return index_or(webp->second, "source", -1);
}

/// Returns why a texture has no image.
std::string fault_of(const tinygltf::Model& model, const tinygltf::Texture& texture, int image) {
  if (image >= 0) return "names no image of the file, which has " + pluralize(model.images.size(), "image");
  if (texture.extensions.contains("KHR_texture_basisu")) return *missing_codec("KHR_texture_basisu");
  return "is missing: expected a PNG, JPEG or WebP image";
}

}  // namespace

float number_or(const tinygltf::Value& object, const char* key, float otherwise) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsNumber()) return otherwise;
  return float(object.Get(key).GetNumberAsDouble());
}

int index_or(const tinygltf::Value& object, const char* key, int otherwise) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsNumber()) return otherwise;
  return int(std::clamp(object.Get(key).GetNumberAsDouble(), -1.0, double(std::numeric_limits<int>::max())));
}

TextureInfo texture_info(const tinygltf::TextureInfo& info) {
  const auto transform = info.extensions.find(transform_extension);
  return {info.index, info.texCoord, transform == info.extensions.end() ? nullptr : &transform->second};
}

TextureInfo texture_info(const tinygltf::Value& info) {
  TextureInfo out{index_or(info, "index", -1), index_or(info, "texCoord", 0), nullptr};
  if (info.IsObject() && info.Has("extensions") && info.Get("extensions").Has(transform_extension))
    out.transform = &info.Get("extensions").Get(transform_extension);
  return out;
}

void use_texture(const tinygltf::Model& model, const TextureInfo& info, TextureUse& use, TextureSource& source,
                 SourceWarnings& warnings) {
  if (info.index < 0) return;
  const std::string where = "textures[" + std::to_string(info.index) + "]";
  if (std::size_t(info.index) >= model.textures.size()) {
    source.fault = "a material names no texture of the file, which has " + pluralize(model.textures.size(), "texture");
    return;
  }
  source.texcoord_set = info.texcoord_set;
  if (info.transform != nullptr) apply_texture_transform(*info.transform, source);
  const tinygltf::Texture& texture = model.textures[std::size_t(info.index)];
  use.image = image_of(texture);
  if (use.image < 0 || std::size_t(use.image) >= model.images.size()) {
    source.fault = where + ".source: " + fault_of(model, texture, use.image);
    use.image = -1;
  }
  if (texture.sampler < 0) return;
  if (std::size_t(texture.sampler) >= model.samplers.size())
    return warnings.count_loss("samplers that are not there, repeat in their place", where + ".sampler");
  const tinygltf::Sampler& sampler = model.samplers[std::size_t(texture.sampler)];
  use.wrap_s = wrap_of(texture.sampler, "wrapS", sampler.wrapS, warnings);
  use.wrap_t = wrap_of(texture.sampler, "wrapT", sampler.wrapT, warnings);
  use.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
}

}  // namespace gigabake
