#include "viewer/pictures/image_files.h"

// jpeglib.h needs <cstdio>.
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <jpeglib.h>
#include <stdexcept>
#include <vector>

namespace gigabake {
namespace {

constexpr int full_colour_quality = 90;

/// libjpeg reports errors through a callback that must not return, so the callback uses longjmp. The jump skips no
/// destructor.
struct JpegWriter {
  jpeg_compress_struct state{};
  jpeg_error_mgr errors{};
  std::jmp_buf back;
  char message[JMSG_LENGTH_MAX] = "";
  unsigned char* bytes = nullptr;
  unsigned long size = 0;

  JpegWriter() {
    state.err = jpeg_std_error(&errors);
    errors.error_exit = [](j_common_ptr common) {
      auto* writer = static_cast<JpegWriter*>(common->client_data);
      (*common->err->format_message)(common, writer->message);
      std::longjmp(writer->back, 1);
    };
    state.client_data = this;
  }
  ~JpegWriter() {
    jpeg_destroy_compress(&state);
    std::free(bytes);
  }
  JpegWriter(const JpegWriter&) = delete;
  JpegWriter& operator=(const JpegWriter&) = delete;
};

/// Writes the image to `writer`. Returns false on errors; `writer.message` is then the reason. `row` is a buffer of
/// three bytes per pixel of a row.
bool write(JpegWriter& writer, const Picture& picture, int quality, std::uint8_t* row) {
  if (setjmp(writer.back) != 0) return false;
  jpeg_create_compress(&writer.state);
  jpeg_mem_dest(&writer.state, &writer.bytes, &writer.size);
  writer.state.image_width = JDIMENSION(picture.width);
  writer.state.image_height = JDIMENSION(picture.height);
  writer.state.input_components = 3;
  writer.state.in_color_space = JCS_RGB;
  jpeg_set_defaults(&writer.state);
  jpeg_set_quality(&writer.state, quality, TRUE);
  if (quality >= full_colour_quality)
    writer.state.comp_info[0].h_samp_factor = writer.state.comp_info[0].v_samp_factor = 1;
  jpeg_start_compress(&writer.state, TRUE);
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* rgba = picture.rgba.data() + std::size_t(y) * std::size_t(picture.width) * 4;
    for (int x = 0; x < picture.width; ++x)
      for (int k = 0; k < 3; ++k) row[3 * x + k] = rgba[4 * x + k];
    JSAMPROW rows = row;
    jpeg_write_scanlines(&writer.state, &rows, 1);
  }
  jpeg_finish_compress(&writer.state);
  return true;
}

}  // namespace

std::string encode_jpeg(const Picture& picture, int quality) {
  std::vector<std::uint8_t> row(std::size_t(picture.width) * 3);
  JpegWriter writer;
  if (!write(writer, picture, quality, row.data()))
    throw std::runtime_error(std::string("cannot write a JPEG: ") + writer.message);
  return {reinterpret_cast<const char*>(writer.bytes), writer.size};
}

}  // namespace gigabake
