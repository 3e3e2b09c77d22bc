/// Size of an encoded image, read from its header before memory of that size is allocated.
#pragma once

#include <cstdint>

#include "format/source/mesh.h"

namespace gigabake {

/// Max texels of an image that is decoded row by row, and of an image that is decoded as a whole. Indices of texels and
/// sizes in libpng have 32 bits.
inline constexpr std::uint64_t max_texels = std::uint64_t(1) << 30, max_whole_image_texels = std::uint64_t(1) << 28;

struct ImageSize {
  std::uint64_t width = 0, height = 0;
  /// Returns the bytes of the decoded image with the mip levels of its texture.
  std::uint64_t texture_bytes() const { return texture_bytes_of(width * height); }
  static constexpr std::uint64_t texture_bytes_of(std::uint64_t texels) { return 7 * texels; }
};

/// Returns the size of an image. Reads only the header.
/// Range   The result has 1 to max_texels texels.
/// Errors  InputError: the image is not a PNG, JPEG or WebP (if built with libwebp), has a damaged header, no texels,
///         or more than max_texels.
ImageSize image_size(const EncodedImage& image);

}  // namespace gigabake
