#include "format/source/image/image_rows.h"

#include "format/source/image/encoding.h"
#include "format/source/image/jpeg_reader.h"
#include "format/source/image/png_reader.h"

namespace gigabake {
namespace {

class JpegRows : public ImageRows {
 public:
  JpegRows(const EncodedImage& encoded, const ImageSize& size) : ImageRows(size), encoded_(encoded) {
    reader_.begin(encoded);
  }
  /// Returns false for several scans, because libjpeg would keep the coefficients of all scans until the last scan is
  /// read.
  bool comes_in_rows() { return jpeg_has_multiple_scans(&reader_.state) == FALSE; }
  void next(std::uint8_t* rgba) override { reader_.next_row(encoded_, rgba); }

 private:
  const EncodedImage& encoded_;
  JpegReader reader_;
};

class PngRows : public ImageRows {
 public:
  PngRows(const EncodedImage& encoded, const ImageSize& size) : ImageRows(size), reader_(encoded) {}
  bool comes_in_rows() const { return !reader_.is_interlaced(); }
  void next(std::uint8_t* rgba) override { reader_.read_row(rgba); }

 private:
  PngReader reader_;
};

template <class Rows>
std::unique_ptr<ImageRows> rows_of(const EncodedImage& encoded) {
  auto rows = std::make_unique<Rows>(encoded, image_size(encoded));
  if (!rows->comes_in_rows()) return nullptr;
  return rows;
}

}  // namespace

std::unique_ptr<ImageRows> ImageRows::open(const EncodedImage& encoded) {
  switch (encoding_of(encoded)) {
    case Encoding::png:
      return rows_of<PngRows>(encoded);
    case Encoding::jpeg:
      return rows_of<JpegRows>(encoded);
    case Encoding::webp:
      break;
  }
  return nullptr;
}

}  // namespace gigabake
