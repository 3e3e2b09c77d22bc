/// What a glTF document says about itself, checked before any library follows an index or an offset of it.
#pragma once

#include <cstdint>
#include <filesystem>

#include "format/source/source_file.h"
#include "format/source/source_files.h"

namespace gigabake {

/// After this returns: every index (buffer, view, accessor, image, sampler, texture, material, mesh, node) is in range;
/// views lie in their buffers and accessors in their views; nodes form a forest; external files lie inside files.root()
/// and hold what the document says; every required extension is one we read. bin_bytes: of the GLB's binary chunk.
/// Errors  InputError(file, "accessors[3].bufferView", …).
void check_gltf(const SourceFiles& files, const std::filesystem::path& file, const Json& gltf, std::uint64_t bin_bytes);

}  // namespace gigabake
