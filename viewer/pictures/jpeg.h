/// Images as JPEG files, for streams.
#pragma once

#include <string>

#include "viewer/pictures/picture.h"

namespace gigabake {

/// Returns the file's bytes; alpha is dropped. quality: 1 to 100; below 90 the chroma channels have half the
/// resolution.
/// Exact   Equal images give equal bytes.
/// Errors  std::runtime_error: libjpeg's message.
std::string encode_jpeg(const Picture& picture, int quality);

}  // namespace gigabake
