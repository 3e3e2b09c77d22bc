/// KHR_draco_mesh_compression: primitives whose indices and attributes are packed as one mesh.
#pragma once

#include <filesystem>

#include "format/source/gltf/load.h"
#include "format/source/source_file.h"

namespace gigabake {

/// Removes the indices of packed primitives from a checked document: tinygltf refuses indices without bytes.
void hide_packed_indices(Json& gltf);

/// Unpacks every primitive that has no plain copy, and gives it new accessors: floats, and 32-bit indices. A primitive
/// with a plain copy is not unpacked; its plain copy is read.
/// gltf: the document before hide_packed_indices().
/// Errors  InputError, as decode_draco(); an accessor of an attribute does not exist.
void unpack_draco(const std::filesystem::path& file, const Json& gltf, GltfDocument& document);

}  // namespace gigabake
