#include "format/source/image/jpeg_reader.h"

#include <string>

#include "core/base/error.h"

namespace gigabake {
namespace {

/// Converts texels from inverted CMYK to opaque RGB. Adobe writes inverted CMYK, in which 255 means no ink.
void rgb_from_inverted_cmyk(std::uint8_t* texels, std::size_t count) {
  for (std::size_t i = 0; i < 4 * count; i += 4) {
    for (std::size_t c = 0; c < 3; ++c) texels[i + c] = std::uint8_t((texels[i + c] * texels[i + 3] + 127) / 255);
    texels[i + 3] = 255;
  }
}

}  // namespace

JpegReader::JpegReader() {
  state.err = jpeg_std_error(&errors);
  state.client_data = this;
  errors.error_exit = [](j_common_ptr s) { give_up(s); };
  errors.emit_message = [](j_common_ptr s, int level) {
    // libjpeg only warns of a damaged or short file. Stray bytes between markers are common and harmless.
    if (level < 0 && s->err->msg_code != JWRN_EXTRANEOUS_DATA) give_up(s);
  };
  jpeg_create_decompress(&state);
}

void JpegReader::give_up(j_common_ptr s) {
  auto* reader = static_cast<JpegReader*>(s->client_data);
  s->err->format_message(s, reader->message);
  std::longjmp(reader->back, 1);
}

bool JpegReader::read_header(const EncodedImage& encoded) {
  if (setjmp(back) != 0) return false;
  jpeg_mem_src(&state, encoded.bytes.data(), encoded.bytes.size());
  jpeg_read_header(&state, TRUE);
  return true;
}

bool JpegReader::read_row(std::uint8_t* rgba) {
  if (setjmp(back) != 0) return false;
  if (!is_started_) {
    state.out_color_space = state.num_components == 4 ? JCS_CMYK : JCS_EXT_RGBA;
    jpeg_start_decompress(&state);
    is_started_ = true;
  }
  JSAMPROW row = rgba;
  jpeg_read_scanlines(&state, &row, 1);
  if (state.output_scanline == state.output_height) jpeg_finish_decompress(&state);
  return true;
}

void JpegReader::begin(const EncodedImage& encoded) {
  if (!read_header(encoded)) throw InputError(encoded.name, "", std::string("not a whole JPEG: ") + message);
}

void JpegReader::next_row(const EncodedImage& encoded, std::uint8_t* rgba) {
  if (!read_row(rgba)) throw InputError(encoded.name, "", std::string("not a whole JPEG: ") + message);
  if (state.num_components == 4) rgb_from_inverted_cmyk(rgba, state.image_width);
}

}  // namespace gigabake
