// decode_image(): PNG, JPEG and WebP to straight RGBA.
#include <string_view>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "format/source/image/codecs.h"
#include "format/source/image/encoding.h"
#include "format/source/image/image_size.h"
#include "format/source/image/jpeg_reader.h"
#include "format/source/image/png_reader.h"
#include "format/source/mesh.h"

namespace gigabake {
namespace {

[[noreturn]] void fail(const EncodedImage& image, const std::string& message) {
  throw InputError(image.name, "", message);
}

std::string texels_of(const ImageSize& size) {
  return std::to_string(size.width) + " × " + std::to_string(size.height) + " texels";
}

ImageSize checked(const EncodedImage& image, const ImageSize& size) {
  if (size.width == 0 || size.height == 0 || size.width > max_texels / size.height)
    fail(image, "has " + texels_of(size) + "; expected 1 to 2^30");
  return size;
}

/// Returns the bytes per texel that the decoder keeps until all texels are decoded.
std::uint64_t decoder_texel_bytes(const EncodedImage& image, Encoding encoding) {
  constexpr std::uint64_t coefficient_bytes = 2, argb_bytes = 4;
  if (encoding == Encoding::webp) return argb_bytes;
  if (encoding == Encoding::png) return 0;
  JpegReader reader;
  reader.begin(image);
  return jpeg_has_multiple_scans(&reader.state) ? coefficient_bytes * std::uint64_t(reader.state.num_components) : 0;
}

/// Claims memory for a whole image before the memory is allocated.
void claim_whole(const EncodedImage& image, const ImageSize& size, Encoding encoding) {
  constexpr const char* advice = "make it smaller";
  if (size.width > max_whole_image_texels / size.height)
    fail(image, "has " + texels_of(size) +
                    "; more than 2^28 are possible only for a PNG without interlacing or a JPEG in one scan, and "
                    "only with a limit of `memory_bytes`");
  MemoryClaim(image.name, advice)
      .add(size.texture_bytes() + decoder_texel_bytes(image, encoding) * size.width * size.height, "", texels_of(size));
}

Image decode_png(const EncodedImage& encoded) {
  PngReader reader(encoded);
  const ImageSize size = reader.size();
  Image out{int(size.width), int(size.height), std::vector<std::uint8_t>(4 * size.width * size.height), false};
  reader.read_all(out.rgba.data());
  return out;
}

Image decode_jpeg(const EncodedImage& encoded) {
  JpegReader reader;
  reader.begin(encoded);
  Image out{int(reader.state.image_width), int(reader.state.image_height), {}, false};
  const std::size_t stride = std::size_t(4) * reader.state.image_width;
  out.rgba.resize(stride * reader.state.image_height);
  for (std::size_t row = 0; row < std::size_t(out.height); ++row) reader.next_row(encoded, &out.rgba[stride * row]);
  return out;
}

ImageSize stated_size(const EncodedImage& encoded, Encoding encoding) {
  if (encoding == Encoding::webp) return webp_size(encoded);
  if (encoding == Encoding::png) return PngReader(encoded).size();
  JpegReader reader;
  reader.begin(encoded);
  return {reader.state.image_width, reader.state.image_height};
}

}  // namespace

Encoding encoding_of(const EncodedImage& encoded) {
  const std::string_view bytes(reinterpret_cast<const char*>(encoded.bytes.data()), encoded.bytes.size());
  if (bytes.size() > 12 && bytes.starts_with("\x89PNG")) return Encoding::png;
  if (bytes.size() > 12 && bytes.starts_with("\xff\xd8\xff")) return Encoding::jpeg;
  if (bytes.size() > 12 && bytes.starts_with("RIFF") && bytes.substr(8).starts_with("WEBP")) return Encoding::webp;
  fail(encoded, "neither PNG nor JPEG nor WebP");
}

ImageSize image_size(const EncodedImage& encoded) {
  return checked(encoded, stated_size(encoded, encoding_of(encoded)));
}

Image decode_image(const EncodedImage& encoded) {
  const Encoding encoding = encoding_of(encoded);
  const ImageSize size = checked(encoded, stated_size(encoded, encoding));
  claim_whole(encoded, size, encoding);
  Image out = encoding == Encoding::png    ? decode_png(encoded)
              : encoding == Encoding::jpeg ? decode_jpeg(encoded)
                                           : decode_webp(encoded);
  for (std::size_t i = 3; i < out.rgba.size() && !out.has_alpha; i += 4) out.has_alpha = out.rgba[i] != 255;
  return out;
}

}  // namespace gigabake
