#include "format/source/image/png_reader.h"

#include <algorithm>
#include <csetjmp>

#include "core/base/error.h"

namespace gigabake {
namespace {

void ignore_warning(png_structp, png_const_charp) {}

}  // namespace

PngReader::PngReader(const EncodedImage& encoded) : encoded_(encoded), left_(encoded.bytes) {
  png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, fail, ignore_warning);
  if (png_ != nullptr) info_ = png_create_info_struct(png_);
  if (info_ == nullptr || !begin()) {
    png_destroy_read_struct(&png_, &info_, nullptr);
    refuse();
  }
}

PngReader::~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }

ImageSize PngReader::size() const { return {png_get_image_width(png_, info_), png_get_image_height(png_, info_)}; }

bool PngReader::is_interlaced() const { return passes_ > 1; }

void PngReader::fail(png_structp png, png_const_charp message) {
  static_cast<PngReader*>(png_get_error_ptr(png))->message_ = message;
  png_longjmp(png, 1);
}

void PngReader::read_bytes(png_structp png, png_bytep to, std::size_t count) {
  auto& left = static_cast<PngReader*>(png_get_io_ptr(png))->left_;
  if (count > left.size()) png_error(png, "read beyond end of data");
  std::copy_n(left.begin(), count, to);
  left = left.subspan(count);
}

void PngReader::refuse() const { throw InputError(encoded_.name, "", "not a whole PNG: " + message_); }

bool PngReader::begin() {
  if (setjmp(png_jmpbuf(png_)) != 0) return false;
  png_set_benign_errors(png_, 1);
  // Skips all chunks except IHDR, PLTE, tRNS, IDAT and IEND. Colour management therefore has no effect, and damage in
  // other chunks does no harm.
  png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
  png_set_read_fn(png_, this, read_bytes);
  png_read_info(png_, info_);
  const int type = png_get_color_type(png_, info_);
  png_set_expand(png_);
  if ((type & PNG_COLOR_MASK_COLOR) == 0) png_set_gray_to_rgb(png_);
  if (png_get_bit_depth(png_, info_) == 16) png_set_scale_16(png_);
  if ((type & PNG_COLOR_MASK_ALPHA) == 0 && png_get_valid(png_, info_, PNG_INFO_tRNS) == 0)
    png_set_add_alpha(png_, 255, PNG_FILLER_AFTER);
  passes_ = png_set_interlace_handling(png_);
  png_read_update_info(png_, info_);
  if (png_get_rowbytes(png_, info_) != 4 * size().width) png_error(png_, "does not unpack to RGBA");
  return true;
}

bool PngReader::try_rows(std::uint8_t* rgba, png_uint_32 count, int passes) {
  if (setjmp(png_jmpbuf(png_)) != 0) return false;
  const std::size_t row_bytes = 4 * size().width;
  for (int pass = 0; pass < passes; ++pass)
    for (png_uint_32 row = 0; row < count; ++row) png_read_row(png_, rgba + row * row_bytes, nullptr);
  return true;
}

void PngReader::read_row(std::uint8_t* rgba) {
  if (!try_rows(rgba, 1, 1)) refuse();
}

void PngReader::read_all(std::uint8_t* rgba) {
  if (!try_rows(rgba, png_uint_32(size().height), passes_)) refuse();
}

}  // namespace gigabake
