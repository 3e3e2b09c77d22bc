/// Images as PNG files.
#pragma once

#include <filesystem>
#include <string>

#include "viewer/pictures/picture.h"

namespace gigabake {

/// Returns the file's bytes: RGB if every pixel is opaque, otherwise RGBA.
/// Exact   Equal images give equal bytes.
/// Errors  std::runtime_error: libpng's message.
std::string encode_png(const Picture& picture);

/// Writes the result of encode_png(). Replaces `path` atomically.
/// Errors  InputError, naming the file and the system's reason; no partial file remains.
void write_png(const std::filesystem::path& path, const Picture& picture);

}  // namespace gigabake
