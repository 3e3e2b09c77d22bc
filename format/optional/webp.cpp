#include <webp/decode.h>

#include "format/codecs.h"
#include "format/error.h"

namespace gigabake {

bool has_webp() { return true; }

Image decode_webp(const EncodedImage& image) {
  constexpr std::uint64_t most_texels = std::uint64_t(1) << 28;
  Image out;
  if (WebPGetInfo(image.bytes.data(), image.bytes.size(), &out.width, &out.height) == 0)
    throw InputError(image.name, "", "not a whole WebP: its header");
  if (std::uint64_t(out.width) * std::uint64_t(out.height) > most_texels)
    throw InputError(
        image.name, "",
        "has " + std::to_string(out.width) + " × " + std::to_string(out.height) + " texels; expected at most 2^28");
  out.rgba.resize(std::size_t(4) * std::size_t(out.width) * std::size_t(out.height));
  if (WebPDecodeRGBAInto(image.bytes.data(), image.bytes.size(), out.rgba.data(), out.rgba.size(), 4 * out.width) ==
      nullptr)
    throw InputError(image.name, "", "not a whole WebP, or an animation");
  return out;
}

}  // namespace gigabake
