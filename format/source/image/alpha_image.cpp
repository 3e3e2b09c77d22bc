#include "format/source/image/alpha_image.h"

#include "format/source/image/png_bytes.h"

namespace gigabake {

EncodedImage with_alpha(const std::optional<EncodedImage>& color, const EncodedImage& alpha) {
  const Image shape = decode_image(alpha);
  Image out = color ? decode_image(*color) : shape;
  const auto width = std::size_t(out.width), height = std::size_t(out.height);
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t from_x = x * std::size_t(shape.width) / width, from_y = y * std::size_t(shape.height) / height;
      const std::uint8_t* from = &shape.rgba[4 * (from_y * std::size_t(shape.width) + from_x)];
      std::uint8_t* to = &out.rgba[4 * (y * width + x)];
      if (!color) to[0] = to[1] = to[2] = 255;
      to[3] = shape.has_alpha ? from[3] : from[0];
    }
  const std::string name = (color ? color->name + " + " : "") + alpha.name;
  return {name, png_bytes(name, out.width, out.height, out.rgba)};
}

}  // namespace gigabake
