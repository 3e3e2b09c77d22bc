/// A texture's scratch file, made of an image that comes row by row: of each level a few rows are in memory.
#pragma once

#include <filesystem>

#include "format/source/image/image_rows.h"
#include "worker/materials.h"

namespace gigabake {

/// Exact   The file of write_texture() with the same image and recipe, byte for byte.
/// Cost    One thread; memory for some six rows of the image and 256 KiB a level.
/// Errors  As ImageRows::next(). IoError: the file and the system's reason.
void write_texture_rows(const std::filesystem::path& target, ImageRows& image, const TextureRecipe& recipe);

}  // namespace gigabake
