#include "sample/settlement/picture.h"

#include <cstdio>
// jpeglib.h needs FILE to be declared before it.
#include <algorithm>
#include <cstdlib>
#include <jpeglib.h>
#include <png.h>
#include <stdexcept>
#include <string>

namespace gigabake::sample {
namespace {

std::uint8_t byte_of(double v) { return std::uint8_t(std::clamp(v, 0.0, 255.0) + 0.5); }

[[noreturn]] void fail_jpeg(j_common_ptr info) {
  char text[JMSG_LENGTH_MAX];
  (*info->err->format_message)(info, text);
  throw std::runtime_error(std::string("JPEG encoder: ") + text);
}

struct JpegEncoder {
  jpeg_error_mgr errors{};
  jpeg_compress_struct info{};
  unsigned char* memory = nullptr;
  unsigned long size = 0;

  JpegEncoder() {
    info.err = jpeg_std_error(&errors);
    errors.error_exit = fail_jpeg;
    jpeg_create_compress(&info);
    jpeg_mem_dest(&info, &memory, &size);
  }
  JpegEncoder(const JpegEncoder&) = delete;
  JpegEncoder& operator=(const JpegEncoder&) = delete;
  ~JpegEncoder() {
    jpeg_destroy_compress(&info);
    std::free(memory);
  }
};

}  // namespace

Rgb mix(const Rgb& a, const Rgb& b, double t) {
  return {a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t};
}

Rgb scaled(const Rgb& c, double factor) { return {c.r * factor, c.g * factor, c.b * factor}; }

void Picture::set(int x, int y, const Rgb& c) {
  std::uint8_t* p = at(x, y);
  p[0] = byte_of(c.r);
  p[1] = byte_of(c.g);
  p[2] = byte_of(c.b);
}

std::vector<std::uint8_t> to_jpeg(const Picture& picture, int quality) {
  JpegEncoder encoder;
  jpeg_compress_struct& info = encoder.info;
  info.image_width = JDIMENSION(picture.width);
  info.image_height = JDIMENSION(picture.height);
  info.input_components = 3;
  info.in_color_space = JCS_RGB;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, quality, TRUE);
  info.dct_method = JDCT_ISLOW;
  jpeg_start_compress(&info, TRUE);
  while (info.next_scanline < info.image_height) {
    const std::uint8_t* bytes = &picture.bytes[std::size_t(info.next_scanline) * picture.width * 3];
    JSAMPROW row = const_cast<JSAMPROW>(bytes);
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  return {encoder.memory, encoder.memory + encoder.size};
}

std::vector<std::uint8_t> to_png(const Picture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = png_uint_32(picture.width);
  image.height = png_uint_32(picture.height);
  image.format = picture.channels == 4 ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::uint8_t> bytes(size);
  if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.bytes.data(), 0, nullptr))
    throw std::runtime_error(std::string("PNG encoder: ") + image.message);
  bytes.resize(size);
  return bytes;
}

}  // namespace gigabake::sample
