/// Can an image be decoded? Found out from its header and its end, since all texels would take long.
#pragma once

#include <filesystem>
#include <string>

#include "format/source/source_bytes.h"

namespace gigabake {

/// Cost    Reads the header, and what tells where the image ends.
/// Errors  InputError(file, key): no bytes, no PNG, JPEG or WebP, a damaged header, or an image that is cut short.
void check_image(const std::filesystem::path& file, const std::string& key, const SourceBytes& bytes);

}  // namespace gigabake
