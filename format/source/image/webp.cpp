#include <webp/decode.h>

#include "core/base/error.h"
#include "format/source/image/codecs.h"

namespace gigabake {

bool has_webp() { return true; }

ImageSize webp_size(const EncodedImage& image) {
  int width = 0, height = 0;
  if (WebPGetInfo(image.bytes.data(), image.bytes.size(), &width, &height) == 0)
    throw InputError(image.name, "", "not a whole WebP: its header");
  return {std::uint64_t(width), std::uint64_t(height)};
}

bool is_lossy_webp(const EncodedImage& image) {
  constexpr int lossless = 2;
  WebPBitstreamFeatures features;
  return WebPGetFeatures(image.bytes.data(), image.bytes.size(), &features) != VP8_STATUS_OK ||
         features.format != lossless;
}

Image decode_webp(const EncodedImage& image) {
  Image out;
  const ImageSize size = webp_size(image);
  out.width = int(size.width), out.height = int(size.height);
  out.rgba.resize(std::size_t(4) * std::size_t(out.width) * std::size_t(out.height));
  if (WebPDecodeRGBAInto(image.bytes.data(), image.bytes.size(), out.rgba.data(), out.rgba.size(), 4 * out.width) ==
      nullptr)
    throw InputError(image.name, "", "not a whole WebP, or an animation");
  return out;
}

}  // namespace gigabake
