/// Decodes an image row by row, for whoever has no room for all of it.
#pragma once

#include <cstdint>
#include <memory>

#include "format/source/image/image_size.h"
#include "format/source/mesh.h"

namespace gigabake {

class ImageRows {
 public:
  /// Null for what no row can be told of before all is read: WebP, a PNG that is interlaced, a JPEG in several scans.
  /// encoded: outlives it.
  /// Errors  InputError, as image_size().
  static std::unique_ptr<ImageRows> open(const EncodedImage& encoded);
  virtual ~ImageRows() = default;

  const ImageSize& size() const { return size_; }
  /// rgba: room for 4 · width bytes. Range  Once for each row, row 0 first.
  /// Exact   The bytes of decode_image().
  /// Errors  InputError, as decode_image().
  virtual void next(std::uint8_t* rgba) = 0;

 protected:
  explicit ImageRows(const ImageSize& size) : size_(size) {}

 private:
  const ImageSize size_;
};

}  // namespace gigabake
