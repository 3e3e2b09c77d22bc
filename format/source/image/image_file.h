/// Image files that meshes name.
#pragma once

#include <filesystem>

#include "format/source/source_files.h"

namespace gigabake {

/// Does the file begin as a PNG, JPEG or WebP does? Cost  reads its first bytes.
bool is_image_file(const SourceFiles& files, const std::filesystem::path& file);

}  // namespace gigabake
