/// A picture as a PNG file.
#pragma once

#include <filesystem>

#include "viewer/picture.h"

namespace gigabake {

/// RGB where every pixel is opaque, else RGBA. Replaces `path` atomically.
/// Exact   Equal pictures give equal files.
/// Errors  InputError: the path and the system's reason; nothing is left behind.
void write_png(const std::filesystem::path& path, const Picture& picture);

}  // namespace gigabake
