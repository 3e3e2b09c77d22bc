#include <png.h>
#include <stdexcept>
#include <string>
#include <vector>

#include "format/system/publish.h"
#include "viewer/pictures/image_files.h"

namespace gigabake {
namespace {

bool is_opaque(const Picture& picture) {
  for (std::size_t i = 3; i < picture.rgba.size(); i += 4)
    if (picture.rgba[i] != 255) return false;
  return true;
}

std::vector<std::uint8_t> without_alpha(const std::vector<std::uint8_t>& rgba) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(rgba.size() / 4 * 3);
  for (std::size_t i = 0; i < rgba.size(); i += 4) rgb.insert(rgb.end(), &rgba[i], &rgba[i] + 3);
  return rgb;
}

}  // namespace

std::string encode_png(const Picture& picture) {
  const bool opaque = is_opaque(picture);
  const std::vector<std::uint8_t> rgb = opaque ? without_alpha(picture.rgba) : std::vector<std::uint8_t>();
  const std::uint8_t* pixels = opaque ? rgb.data() : picture.rgba.data();
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = png_uint_32(picture.width);
  image.height = png_uint_32(picture.height);
  image.format = opaque ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
  image.flags = PNG_IMAGE_FLAG_FAST;  // one thread compresses: 0.4 of the time for a tenth more bytes
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  const int written = png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels, 0, nullptr);
  const std::string message = image.message;
  png_image_free(&image);
  if (written == 0) throw std::runtime_error("cannot make a PNG: " + message);
  bytes.resize(size);
  return bytes;
}

void write_png(const std::filesystem::path& path, const Picture& picture) { publish_file(path, encode_png(picture)); }

}  // namespace gigabake
