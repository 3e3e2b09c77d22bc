/// Check whether an image can be decoded, from its header and its end: decoding all texels would take long.
#pragma once

#include <filesystem>
#include <string>

#include "format/source/content/source_bytes.h"

namespace gigabake {

/// Checks an image.
/// Cost    Reads the header and the bytes that show where the image ends.
/// Errors  InputError(file, key): no bytes, no PNG, JPEG or WebP, a damaged header, or an image that is cut short.
void check_image(const std::filesystem::path& file, const std::string& key, const SourceBytes& bytes);

}  // namespace gigabake
