/// libjpeg's state, and the way back out of it.
#pragma once

#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <cstdio>

// jpeglib.h needs <cstdio>, and jerror.h needs it.
// clang-format off
#include <jpeglib.h>
#include <jerror.h>
// clang-format on

#include "format/source/mesh.h"

namespace gigabake {

/// libjpeg reports through callbacks that must not return; a jump leads back to where `back` was set. No C++ object
/// dies on its way.
struct JpegReader {
  jpeg_decompress_struct state{};
  jpeg_error_mgr errors{};
  std::jmp_buf back{};
  char message[JMSG_LENGTH_MAX] = {};

  JpegReader();
  ~JpegReader() { jpeg_destroy_decompress(&state); }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

  /// Errors  InputError.
  void begin(const EncodedImage& encoded);
  /// The next row as RGBA, of `state.image_width` texels; the first starts the decoder, the last ends it.
  /// Errors  InputError.
  void next_row(const EncodedImage& encoded, std::uint8_t* rgba);

 private:
  bool read_header(const EncodedImage& encoded);
  bool read_row(std::uint8_t* rgba);
  [[noreturn]] static void give_up(j_common_ptr s);
  bool is_started_ = false;
};

}  // namespace gigabake
