// decode_image(): PNG, JPEG and WebP to straight RGBA.
#include <csetjmp>
#include <cstdio>
#include <cstring>

// jpeglib.h needs <cstdio>, and jerror.h needs it.
// clang-format off
#include <jpeglib.h>
#include <jerror.h>
// clang-format on
#include <png.h>

#include "format/codecs.h"
#include "format/error.h"
#include "format/mesh.h"

namespace gigabake {
namespace {

constexpr std::uint64_t most_texels = std::uint64_t(1) << 28;

[[noreturn]] void fail(const EncodedImage& image, const std::string& message) {
  throw InputError(image.name, "", message);
}

void check_size(const EncodedImage& image, std::uint64_t width, std::uint64_t height) {
  if (width == 0 || height == 0 || width > most_texels / height)
    fail(image, "has " + std::to_string(width) + " × " + std::to_string(height) + " texels; expected 1 to 2^28");
}

/// Frees libpng's state on every way out.
struct PngReader {
  png_image image{};
  PngReader() { image.version = PNG_IMAGE_VERSION; }
  ~PngReader() { png_image_free(&image); }
};

Image decode_png(const EncodedImage& encoded) {
  PngReader reader;
  if (png_image_begin_read_from_memory(&reader.image, encoded.bytes.data(), encoded.bytes.size()) == 0)
    fail(encoded, std::string("not a whole PNG: ") + reader.image.message);
  check_size(encoded, reader.image.width, reader.image.height);
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

bool read_jpeg_header(JpegReader& reader, const EncodedImage& encoded) {
  if (setjmp(reader.back) != 0) return false;
  jpeg_mem_src(&reader.state, encoded.bytes.data(), encoded.bytes.size());
  jpeg_read_header(&reader.state, TRUE);
  return true;
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
  if (!read_jpeg_header(reader, encoded)) fail(encoded, std::string("not a whole JPEG: ") + reader.message);
  check_size(encoded, reader.state.image_width, reader.state.image_height);
  Image out{int(reader.state.image_width), int(reader.state.image_height), {}, false};
  out.rgba.resize(std::size_t(4) * reader.state.image_width * reader.state.image_height);
  if (!read_jpeg_rows(reader, out.rgba.data())) fail(encoded, std::string("not a whole JPEG: ") + reader.message);
  if (reader.state.num_components == 4) rgb_from_inverted_cmyk(out.rgba);
  return out;
}

bool is_webp(const std::vector<std::uint8_t>& bytes) {
  return bytes.size() > 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 &&
         std::memcmp(bytes.data() + 8, "WEBP", 4) == 0;
}

}  // namespace

Image decode_image(const EncodedImage& encoded) {
  static constexpr std::uint8_t png_magic[4] = {0x89, 'P', 'N', 'G'}, jpeg_magic[3] = {0xff, 0xd8, 0xff};
  const auto starts_with = [&](const std::uint8_t* magic, std::size_t size) {
    return encoded.bytes.size() > size && std::memcmp(encoded.bytes.data(), magic, size) == 0;
  };
  Image out;
  if (starts_with(png_magic, sizeof png_magic))
    out = decode_png(encoded);
  else if (starts_with(jpeg_magic, sizeof jpeg_magic))
    out = decode_jpeg(encoded);
  else if (is_webp(encoded.bytes))
    out = decode_webp(encoded);
  else
    fail(encoded, "neither PNG nor JPEG nor WebP");
  for (std::size_t i = 3; i < out.rgba.size() && !out.has_alpha; i += 4) out.has_alpha = out.rgba[i] != 255;
  return out;
}

}  // namespace gigabake
