#include "format/source/image/png_bytes.h"

#include <png.h>

#include "core/base/error.h"

namespace gigabake {

std::vector<std::uint8_t> png_bytes(const std::string& name, int width, int height,
                                    std::span<const std::uint8_t> texels) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = png_uint_32(width);
  png.height = png_uint_32(height);
  png.format =
      texels.size() == std::size_t(4) * std::size_t(width) * std::size_t(height) ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
  png.flags = PNG_IMAGE_FLAG_FAST;
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::vector<std::uint8_t> out(bytes);
  if (png_image_write_to_memory(&png, out.data(), &bytes, 0, texels.data(), 0, nullptr) == 0)
    throw InputError(name, "", png.message);
  out.resize(bytes);
  return out;
}

}  // namespace gigabake
