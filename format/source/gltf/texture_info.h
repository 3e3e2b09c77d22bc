/// What a glTF material names as a texture: image, sampler, set of coordinates and their transform.
#pragma once

#include <string>
#include <tiny_gltf.h>

#include "format/source/gltf/material.h"

namespace gigabake {

/// A member of an extension's object, or `otherwise` where it is no number.
float number_or(const tinygltf::Value& object, const char* key, float otherwise);

/// A textureInfo as the core and the extensions write it.
struct TextureInfo {
  int index = -1;  ///< in the model's textures; -1: none
  int texcoord_set = 0;
  const tinygltf::Value* transform = nullptr;  ///< KHR_texture_transform
};

TextureInfo texture_info(const tinygltf::TextureInfo& info);
/// Of a textureInfo inside an extension, which nothing has checked.
TextureInfo texture_info(const tinygltf::Value& info);

/// Sets the texture, its coordinates and, where it has no image that can be used, the fault.
void use_texture(const tinygltf::Model& model, const TextureInfo& info, SourceMaterial& out, SourceWarnings& warnings);

}  // namespace gigabake
