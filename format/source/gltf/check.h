/// Checks of a glTF document before its indices and offsets are used.
#pragma once

#include <cstdint>
#include <filesystem>

#include "format/source/source_file.h"
#include "format/source/source_files.h"

namespace gigabake {

/// Checks a document. Afterwards every index of a buffer, view, accessor, material, mesh or node is in range. Indices
/// of textures, samplers and images are not checked, because a wrong index costs only one image. Views are within their
/// buffers, accessors are within their views, and nodes form a forest. External buffers are inside files.root() and are
/// large enough. Every required extension is supported. `bin_bytes` is the size of the GLB's binary chunk.
/// Errors  InputError(file, path of the member), for example of "accessors[3].bufferView".
void check_gltf(const SourceFiles& files, const std::filesystem::path& file, const Json& gltf, std::uint64_t bin_bytes);

/// Checks that animations, skins, cameras and lights have their required members. No bake uses them, but a file in
/// which they are malformed is damaged or has another version.
/// `gltf` must have passed the other checks of check_gltf(), which calls this function.
/// Errors  InputError: a required member is missing or has a wrong type.
void check_unused_states(const std::filesystem::path& file, const Json& gltf);

}  // namespace gigabake
