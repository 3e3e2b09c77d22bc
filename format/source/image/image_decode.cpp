// decode_image(): PNG, JPEG and WebP to straight RGBA.
#include <csetjmp>
#include <cstdio>
#include <string_view>

// jpeglib.h needs <cstdio>, and jerror.h needs it.
// clang-format off
#include <jpeglib.h>
#include <jerror.h>
// clang-format on
#include <png.h>

#include "format/source/image/codecs.h"
#include "format/source/image/image_size.h"
#include "format/source/mesh.h"
#include "lattice/error.h"
#include "lattice/memory_limit.h"

namespace gigabake {
namespace {

constexpr std::uint64_t most_texels = std::uint64_t(1) << 28;

[[noreturn]] void fail(const EncodedImage& image, const std::string& message) {
  throw InputError(image.name, "", message);
}

std::string texels_of(const ImageSize& size) {
  return std::to_string(size.width) + " × " + std::to_string(size.height) + " texels";
}

ImageSize checked(const EncodedImage& image, const ImageSize& size) {
  if (size.width == 0 || size.height == 0 || size.width > most_texels / size.height)
    fail(image, "has " + texels_of(size) + "; expected 1 to 2^28");
  return size;
}

/// Frees libpng's state on every way out.
struct PngReader {
  png_image image{};
  PngReader() { image.version = PNG_IMAGE_VERSION; }
  ~PngReader() { png_image_free(&image); }
};

void begin_png(PngReader& reader, const EncodedImage& encoded) {
  if (png_image_begin_read_from_memory(&reader.image, encoded.bytes.data(), encoded.bytes.size()) == 0)
    fail(encoded, std::string("not a whole PNG: ") + reader.image.message);
}

Image decode_png(const EncodedImage& encoded) {
  PngReader reader;
  begin_png(reader, encoded);
  reader.image.format = PNG_FORMAT_RGBA;
  Image out{int(reader.image.width), int(reader.image.height), std::vector<std::uint8_t>(PNG_IMAGE_SIZE(reader.image)),
            false};
  if (png_image_finish_read(&reader.image, nullptr, out.rgba.data(), 0, nullptr) == 0 || PNG_IMAGE_FAILED(reader.image))
    fail(encoded, std::string("not a whole PNG: ") + reader.image.message);
  return out;
}

/// libjpeg reports through callbacks that must not return; a jump leads back here. No C++ object dies on its way.
struct JpegReader {
  jpeg_decompress_struct state{};
  jpeg_error_mgr errors{};
  std::jmp_buf back{};
  char message[JMSG_LENGTH_MAX] = {};

  JpegReader() {
    state.err = jpeg_std_error(&errors);
    state.client_data = this;
    errors.error_exit = [](j_common_ptr s) { give_up(s); };
    errors.emit_message = [](j_common_ptr s, int level) {
      // A damaged or short file is only a warning to libjpeg; stray bytes between markers are common and harmless.
      if (level < 0 && s->err->msg_code != JWRN_EXTRANEOUS_DATA) give_up(s);
    };
    jpeg_create_decompress(&state);
  }
  ~JpegReader() { jpeg_destroy_decompress(&state); }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

 private:
  [[noreturn]] static void give_up(j_common_ptr s) {
    auto* reader = static_cast<JpegReader*>(s->client_data);
    s->err->format_message(s, reader->message);
    std::longjmp(reader->back, 1);
  }
};

bool has_jpeg_header(JpegReader& reader, const EncodedImage& encoded) {
  if (setjmp(reader.back) != 0) return false;
  jpeg_mem_src(&reader.state, encoded.bytes.data(), encoded.bytes.size());
  jpeg_read_header(&reader.state, TRUE);
  return true;
}

void begin_jpeg(JpegReader& reader, const EncodedImage& encoded) {
  if (!has_jpeg_header(reader, encoded)) fail(encoded, std::string("not a whole JPEG: ") + reader.message);
}

/// rows: room for `height` rows of width × 4 bytes.
bool read_jpeg_rows(JpegReader& reader, std::uint8_t* rows) {
  if (setjmp(reader.back) != 0) return false;
  reader.state.out_color_space = reader.state.num_components == 4 ? JCS_CMYK : JCS_EXT_RGBA;
  jpeg_start_decompress(&reader.state);
  const std::size_t stride = std::size_t(reader.state.output_width) * 4;
  while (reader.state.output_scanline < reader.state.output_height) {
    JSAMPROW row = rows + stride * reader.state.output_scanline;
    jpeg_read_scanlines(&reader.state, &row, 1);
  }
  jpeg_finish_decompress(&reader.state);
  return true;
}

/// Adobe writes CMYK inverted: 255 is no ink.
void rgb_from_inverted_cmyk(std::vector<std::uint8_t>& texels) {
  for (std::size_t i = 0; i < texels.size(); i += 4) {
    for (std::size_t c = 0; c < 3; ++c) texels[i + c] = std::uint8_t((texels[i + c] * texels[i + 3] + 127) / 255);
    texels[i + 3] = 255;
  }
}

Image decode_jpeg(const EncodedImage& encoded) {
  JpegReader reader;
  begin_jpeg(reader, encoded);
  Image out{int(reader.state.image_width), int(reader.state.image_height), {}, false};
  out.rgba.resize(std::size_t(4) * reader.state.image_width * reader.state.image_height);
  if (!read_jpeg_rows(reader, out.rgba.data())) fail(encoded, std::string("not a whole JPEG: ") + reader.message);
  if (reader.state.num_components == 4) rgb_from_inverted_cmyk(out.rgba);
  return out;
}

enum class Encoding { png, jpeg, webp };

Encoding encoding_of(const EncodedImage& encoded) {
  const std::string_view bytes(reinterpret_cast<const char*>(encoded.bytes.data()), encoded.bytes.size());
  if (bytes.size() > 12 && bytes.starts_with("\x89PNG")) return Encoding::png;
  if (bytes.size() > 12 && bytes.starts_with("\xff\xd8\xff")) return Encoding::jpeg;
  if (bytes.size() > 12 && bytes.starts_with("RIFF") && bytes.substr(8).starts_with("WEBP")) return Encoding::webp;
  fail(encoded, "neither PNG nor JPEG nor WebP");
}

ImageSize stated_size(const EncodedImage& encoded, Encoding encoding) {
  if (encoding == Encoding::webp) return webp_size(encoded);
  if (encoding == Encoding::png) {
    PngReader reader;
    begin_png(reader, encoded);
    return {reader.image.width, reader.image.height};
  }
  JpegReader reader;
  begin_jpeg(reader, encoded);
  return {reader.state.image_width, reader.state.image_height};
}

}  // namespace

ImageSize image_size(const EncodedImage& encoded) {
  return checked(encoded, stated_size(encoded, encoding_of(encoded)));
}

Image decode_image(const EncodedImage& encoded) {
  const Encoding encoding = encoding_of(encoded);
  const ImageSize size = checked(encoded, stated_size(encoded, encoding));
  MemoryClaim(encoded.name, "make it smaller").add(size.texture_bytes(), "", texels_of(size));
  Image out = encoding == Encoding::png    ? decode_png(encoded)
              : encoding == Encoding::jpeg ? decode_jpeg(encoded)
                                           : decode_webp(encoded);
  for (std::size_t i = 3; i < out.rgba.size() && !out.has_alpha; i += 4) out.has_alpha = out.rgba[i] != 255;
  return out;
}

}  // namespace gigabake
