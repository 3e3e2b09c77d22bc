/// Texture of a glTF material: image, sampler, set of coordinates and their transform.
#pragma once

#include <string>
#include <tiny_gltf.h>

#include "format/source/gltf/material.h"

namespace gigabake {

/// Returns a member of an extension's object; `otherwise` if the member is not a number.
float number_or(const tinygltf::Value& object, const char* key, float otherwise);
/// Returns a member as an index of at least -1; `otherwise` if the member is not a number.
int index_or(const tinygltf::Value& object, const char* key, int otherwise);

/// A textureInfo of core glTF or of an extension.
struct TextureInfo {
  int index = -1;  ///< in the model's textures; -1: none
  int texcoord_set = 0;
  const tinygltf::Value* transform = nullptr;  ///< KHR_texture_transform
};

TextureInfo texture_info(const tinygltf::TextureInfo& info);
/// Reads a textureInfo inside an extension, whose members are not checked.
TextureInfo texture_info(const tinygltf::Value& info);

/// Sets a texture and its coordinates. Sets the fault if the texture has no usable image.
void use_texture(const tinygltf::Model& model, const TextureInfo& info, TextureUse& use, TextureSource& source,
                 SourceWarnings& warnings);

}  // namespace gigabake
