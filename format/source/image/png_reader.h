/// A PNG decoder. It writes straight RGBA with 8 bits per channel, and interprets the stored codes as sRGB.
#pragma once

#include <cstdint>
#include <png.h>
#include <span>
#include <string>

#include "format/source/image/image_size.h"
#include "format/source/mesh.h"

namespace gigabake {

/// Space   Row 0 is first. Chunks that describe a colour space (gAMA, cHRM, sRGB, iCCP) are not read, at any bit depth.
/// Exact   16 bits are rounded to the nearest 8-bit value; fewer bits, palettes and tRNS are expanded.
/// Errors  InputError: the image is not a whole PNG.
/// Source  glTF 2.0, "Images": colour-space information of an image must be ignored.
class PngReader {
 public:
  /// Reads the header. `encoded` must outlive the reader.
  explicit PngReader(const EncodedImage& encoded);
  ~PngReader();
  PngReader(const PngReader&) = delete;

  ImageSize size() const;
  /// Returns whether the image is interlaced. No row of an interlaced image is complete before the whole image is read.
  bool is_interlaced() const;
  /// Writes the next row, 4 · width bytes.
  /// Range   The image is not interlaced.
  void read_row(std::uint8_t* rgba);
  /// Writes the whole image, 4 · width · height bytes.
  void read_all(std::uint8_t* rgba);

 private:
  [[noreturn]] static void fail(png_structp png, png_const_charp message);
  static void read_bytes(png_structp png, png_bytep to, std::size_t count);
  [[noreturn]] void refuse() const;
  bool begin();
  bool try_rows(std::uint8_t* rgba, png_uint_32 count, int passes);

  const EncodedImage& encoded_;
  std::span<const std::uint8_t> left_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  int passes_ = 1;
  std::string message_ = "libpng has no memory";
};

}  // namespace gigabake
