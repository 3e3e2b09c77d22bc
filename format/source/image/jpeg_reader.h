/// libjpeg's state and error handling.
#pragma once

#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <cstdio>

// jpeglib.h needs <cstdio>, and jerror.h needs jpeglib.h.
// clang-format off
#include <jpeglib.h>
#include <jerror.h>
// clang-format on

#include "format/source/mesh.h"

namespace gigabake {

/// Reader of a JPEG. libjpeg reports errors through callbacks that must not return: they jump to `back`. The jump skips
/// no destructor of a C++ object.
struct JpegReader {
  jpeg_decompress_struct state{};
  jpeg_error_mgr errors{};
  std::jmp_buf back{};
  char message[JMSG_LENGTH_MAX] = {};

  JpegReader();
  ~JpegReader() { jpeg_destroy_decompress(&state); }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

  /// Errors  InputError: the image is not a whole JPEG.
  void begin(const EncodedImage& encoded);
  /// Decodes the next row as RGBA, `state.image_width` texels. The first call starts the decoder; the call for the last
  /// row ends it.
  /// Errors  InputError: the image is not a whole JPEG.
  void next_row(const EncodedImage& encoded, std::uint8_t* rgba);

 private:
  bool read_header(const EncodedImage& encoded);
  bool read_row(std::uint8_t* rgba);
  [[noreturn]] static void give_up(j_common_ptr s);
  bool is_started_ = false;
};

}  // namespace gigabake
