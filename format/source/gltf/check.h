/// Checks of a glTF document before its indices and offsets are used.
#pragma once

#include <cstdint>
#include <filesystem>

#include "format/source/source_file.h"
#include "format/source/source_files.h"

namespace gigabake {

/// Checks a document. Afterwards every index (buffer, view, accessor, image, sampler, texture, material, mesh, node) is
/// in range. Views are within their buffers, accessors are within their views, and nodes form a forest. External files
/// are inside files.root() and have the bytes that the document requires. Every required extension is supported.
/// bin_bytes: size of the GLB's binary chunk.
/// Errors  InputError(file, "accessors[3].bufferView", …).
void check_gltf(const SourceFiles& files, const std::filesystem::path& file, const Json& gltf, std::uint64_t bin_bytes);

/// Checks that animations, skins, cameras and lights have their required members. No bake uses them, but a file in
/// which they are malformed is damaged or has another version.
/// gltf: after the other checks of check_gltf(), which calls this function.
/// Errors  InputError.
void check_unused_states(const std::filesystem::path& file, const Json& gltf);

}  // namespace gigabake
