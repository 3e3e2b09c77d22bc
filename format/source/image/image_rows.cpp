#include "format/source/image/image_rows.h"

#include <algorithm>
#include <csetjmp>
#include <png.h>
#include <span>
#include <string>

#include "format/source/image/encoding.h"
#include "format/source/image/jpeg_reader.h"
#include "lattice/error.h"

namespace gigabake {
namespace {

class JpegRows : public ImageRows {
 public:
  JpegRows(const EncodedImage& encoded, const ImageSize& size) : ImageRows(size), encoded_(encoded) {
    reader_.begin(encoded);
  }
  /// Coefficients of all scans would be held until the last one is read.
  bool comes_in_rows() { return jpeg_has_multiple_scans(&reader_.state) == FALSE; }
  void next(std::uint8_t* rgba) override { reader_.next_row(encoded_, rgba); }

 private:
  const EncodedImage& encoded_;
  JpegReader reader_;
};

/// Makes of any PNG the same bytes as libpng's simplified interface, which knows whole images alone: that is its
/// sequence of transformations (png_image_read_direct) for 8-bit RGBA.
class PngRows : public ImageRows {
 public:
  PngRows(const EncodedImage& encoded, const ImageSize& size)
      : ImageRows(size), encoded_(encoded), left_(encoded.bytes) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, fail, ignore);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ == nullptr || !begin()) {
      png_destroy_read_struct(&png_, &info_, nullptr);
      refuse();
    }
  }
  ~PngRows() override { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngRows(const PngRows&) = delete;
  PngRows& operator=(const PngRows&) = delete;

  bool comes_in_rows() const { return png_get_interlace_type(png_, info_) == PNG_INTERLACE_NONE; }
  void next(std::uint8_t* rgba) override {
    if (!read_row(rgba)) refuse();
  }

 private:
  [[noreturn]] static void fail(png_structp png, png_const_charp message) {
    static_cast<PngRows*>(png_get_error_ptr(png))->message_ = message;
    png_longjmp(png, 1);
  }
  static void ignore(png_structp, png_const_charp) {}
  static void read(png_structp png, png_bytep to, std::size_t count) {
    auto& left = static_cast<PngRows*>(png_get_io_ptr(png))->left_;
    if (count > left.size()) png_error(png, "read beyond end of data");
    std::copy_n(left.begin(), count, to);
    left = left.subspan(count);
  }
  [[noreturn]] void refuse() const { throw InputError(encoded_.name, "", "not a whole PNG: " + message_); }

  bool begin() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_benign_errors(png_, 1);
    png_set_read_fn(png_, this, read);
    png_read_info(png_, info_);
    if (!comes_in_rows()) return true;
    const bool is_16_bit = png_get_bit_depth(png_, info_) == 16;
    const int type = png_get_color_type(png_, info_);
    const bool has_alpha = (type & PNG_COLOR_MASK_ALPHA) != 0 || png_get_valid(png_, info_, PNG_INFO_tRNS) != 0;
    png_set_expand(png_);
    if ((type & PNG_COLOR_MASK_COLOR) == 0) png_set_gray_to_rgb(png_);
    png_set_alpha_mode_fixed(png_, PNG_ALPHA_PNG, is_16_bit ? PNG_GAMMA_LINEAR : PNG_DEFAULT_sRGB);
    if (is_16_bit) png_set_scale_16(png_);
    if (!has_alpha) png_set_add_alpha(png_, 255, PNG_FILLER_AFTER);
    png_set_alpha_mode_fixed(png_, PNG_ALPHA_PNG, PNG_DEFAULT_sRGB);
    png_read_update_info(png_, info_);
    if (png_get_rowbytes(png_, info_) != 4 * size().width) png_error(png_, "does not unpack to RGBA");
    return true;
  }

  bool read_row(std::uint8_t* rgba) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_row(png_, rgba, nullptr);
    return true;
  }

  const EncodedImage& encoded_;
  std::span<const std::uint8_t> left_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::string message_ = "libpng has no memory";
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
