/// What an encoded image says of itself, before anything of that size is allocated.
#pragma once

#include <cstdint>

#include "format/source/mesh.h"

namespace gigabake {

struct ImageSize {
  std::uint64_t width = 0, height = 0;
  /// Decoded, with the levels that a texture adds to it.
  std::uint64_t texture_bytes() const { return 7 * width * height; }
};

/// Reads the header alone. Range  1 to 2^28 texels.
/// Errors  InputError: no PNG, JPEG or WebP (where built with libwebp), a header that is damaged, no texels or too
/// many.
ImageSize image_size(const EncodedImage& image);

}  // namespace gigabake
