/// KHR_draco_mesh_compression: primitives whose indices and attributes are one packed mesh.
#pragma once

#include <filesystem>

#include "format/source/gltf/load.h"
#include "format/source/source_file.h"

namespace gigabake {

/// Takes the indices of packed primitives out of a checked document: tinygltf refuses indices without bytes.
void hide_packed_indices(Json& gltf);

/// Unpacks every primitive that has no plain copy, and gives it accessors of its own: floats, and 32-bit indices. Where
/// a plain copy is, it is read, and the packed one not.
/// Errors  InputError as decode_draco(); an attribute whose accessor is none.
/// gltf: the document as it was.
void unpack_draco(const std::filesystem::path& file, const Json& gltf, GltfDocument& document);

}  // namespace gigabake
