/// KHR_draco_mesh_compression: primitives whose indices and attributes are packed as one mesh.
#pragma once

#include <filesystem>

#include "format/source/gltf/load.h"

namespace gigabake {

/// Unpacks every primitive whose positions exist only in the packed mesh. New accessors hold its attributes as floats
/// and its indices with 32 bits. A primitive with uncompressed positions is not unpacked. It loses its indices if these
/// exist only in the packed mesh.
/// Errors  InputError like decode_draco(). Also if the extension has no view or attributes, or the primitive has no
///         indices.
void unpack_draco(const std::filesystem::path& file, GltfDocument& document);

}  // namespace gigabake
