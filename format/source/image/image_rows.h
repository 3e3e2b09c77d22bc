/// Decoder of an image row by row, for callers that cannot keep the whole image in memory.
#pragma once

#include <cstdint>
#include <memory>

#include "format/source/image/image_size.h"
#include "format/source/mesh.h"

namespace gigabake {

class ImageRows {
 public:
  /// Opens an image. Returns null if no row is complete before all bytes are read: WebP, an interlaced PNG, a JPEG in
  /// several scans.
  /// `encoded` must outlive the decoder.
  /// Errors  InputError like image_size().
  static std::unique_ptr<ImageRows> open(const EncodedImage& encoded);
  virtual ~ImageRows() = default;

  const ImageSize& size() const { return size_; }
  /// Decodes the next row into `rgba`, a buffer of 4 · width bytes.
  /// Exact   Equal to the rows of decode_image().
  /// Range   Must be called once per row. Row 0 is first.
  /// Errors  InputError like decode_image().
  virtual void next(std::uint8_t* rgba) = 0;

 protected:
  explicit ImageRows(const ImageSize& size) : size_(size) {}

 private:
  const ImageSize size_;
};

}  // namespace gigabake
