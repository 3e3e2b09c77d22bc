/// Writes a texture's scratch file from an image that is decoded row by row; only a few rows per level are in memory.
#pragma once

#include <filesystem>

#include "format/source/image/image_rows.h"
#include "worker/pipeline/materials.h"

namespace gigabake {

/// Writes the scratch file of `image`, filtered as `filter_key` specifies.
/// Exact   The file has the same bytes as the file that write_texture() writes for the same image and `filter_key`.
/// Cost    Runs on one thread; needs memory for about six rows of the image and 256 KiB per level.
/// Errors  The errors of ImageRows::next(). IoError with the file and the system's reason.
void write_texture_rows(const std::filesystem::path& target, ImageRows& image, const TextureFilterKey& filter_key);

}  // namespace gigabake
