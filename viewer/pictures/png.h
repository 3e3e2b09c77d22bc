/// A picture as a PNG file.
#pragma once

#include <filesystem>
#include <string>

#include "viewer/pictures/picture.h"

namespace gigabake {

/// RGB where every pixel is opaque, else RGBA.
/// Exact   Equal pictures give equal bytes. Errors  std::runtime_error: libpng's message.
std::string encode_png(const Picture& picture);

/// As encode_png(). Replaces `path` atomically.
/// Errors  InputError: the path and the system's reason; nothing is left behind.
void write_png(const std::filesystem::path& path, const Picture& picture);

}  // namespace gigabake
