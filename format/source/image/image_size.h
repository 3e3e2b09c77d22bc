/// What an encoded image says of itself, before anything of that size is allocated.
#pragma once

#include <cstdint>

#include "format/source/mesh.h"

namespace gigabake {

/// Of an image, and of one that is decoded as a whole: indices of texels, and libpng's sizes of images, have 32 bits.
inline constexpr std::uint64_t most_texels = std::uint64_t(1) << 30, most_texels_at_once = std::uint64_t(1) << 28;

struct ImageSize {
  std::uint64_t width = 0, height = 0;
  /// Decoded, with the levels that a texture adds to it.
  std::uint64_t texture_bytes() const { return texture_bytes_of(width * height); }
  static constexpr std::uint64_t texture_bytes_of(std::uint64_t texels) { return 7 * texels; }
};

/// Reads the header alone. Range  1 to most_texels.
/// Errors  InputError: no PNG, JPEG or WebP (where built with libwebp), a header that is damaged, no texels or too
/// many.
ImageSize image_size(const EncodedImage& image);

}  // namespace gigabake
