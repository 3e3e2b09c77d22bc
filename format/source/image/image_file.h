/// Image files that meshes name.
#pragma once

#include <filesystem>

#include "format/source/source_files.h"

namespace gigabake {

/// Returns whether the file begins like a PNG, JPEG or WebP.
/// Cost    Reads the first bytes.
bool is_image_file(const SourceFiles& files, const std::filesystem::path& file);

}  // namespace gigabake
