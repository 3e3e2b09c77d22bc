/// KHR_draco_mesh_compression: primitives whose indices and attributes are packed as one mesh.
#pragma once

#include <filesystem>

#include "format/source/gltf/load.h"

namespace gigabake {

/// Unpacks every primitive that has no plain copy, and gives it new accessors: floats, and 32-bit indices. A primitive
/// with a plain copy is not unpacked; its plain copy is read, without indices if these exist only in the packed mesh.
/// Errors  InputError, as decode_draco(); an accessor of an attribute does not exist.
void unpack_draco(const std::filesystem::path& file, GltfDocument& document);

}  // namespace gigabake
