/// Check whether an image can be decoded. It reads only the header and the end, because decoding all texels would take
/// long.
#pragma once

#include <filesystem>
#include <string>

#include "format/source/content/source_bytes.h"

namespace gigabake {

/// Checks an image.
/// Cost    Reads the header and the bytes that show where the image ends.
/// Errors  InputError(file, key): the image is empty, is not a PNG, JPEG or WebP, has a damaged header, or is
///         truncated.
void check_image(const std::filesystem::path& file, const std::string& key, const SourceBytes& bytes);

}  // namespace gigabake
