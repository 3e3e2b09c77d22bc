/// Textures of ids in glTF: feature ids of EXT_mesh_features that are texels.
#pragma once

#include <filesystem>
#include <string>
#include <tiny_gltf.h>

#include "core/octree/texel_ids.h"
#include "format/source/classes/id_set.h"
#include "format/source/gltf/accessor.h"
#include "format/source/gltf/load.h"
#include "format/source/gltf/material.h"
#include "format/source/mesh.h"
#include "format/source/source_warning.h"

namespace gigabake {

/// The ids of a primitive that are in a texture, and the coordinates of its vertices.
struct IdTextureSource {
  TextureUse texture;
  TexelIds ids;
  TextureSource coordinates;
  AccessorItems uv;
};

/// Returns the texture of ids that `texture`, a member of a set in EXT_mesh_features, describes. The caller sets
/// TexelIds::null_id and TexelIds::add.
/// Errors  The error of `refuse`: a member is wrong, the image cannot be used, or the primitive lacks the coordinates.
IdTextureSource id_texture(const std::filesystem::path& file, const GltfDocument& document,
                           const tinygltf::Primitive& primitive, const tinygltf::Value& texture,
                           const RefuseIds& refuse, SourceWarnings& warnings);

/// Decodes an image of ids and checks that the class of each texel is a class. Counts an image with lossy compression.
/// Errors  The error of `refuse`: the image cannot be decoded or has more than 8 bits per channel, or a class is not
///         from 0 to max_class.
void check_texels(const std::filesystem::path& file, const GltfDocument& document, const IdTextureSource& texture,
                  const RefuseIds& refuse, SourceWarnings& warnings);

}  // namespace gigabake
