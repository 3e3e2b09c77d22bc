#include "format/source/image/grey_image.h"

#include <algorithm>
#include <span>
#include <vector>

#include "format/source/image/image_rows.h"

namespace gigabake {
namespace {

bool has_coloured_texel(std::span<const std::uint8_t> rgba) {
  constexpr int max_difference = 24;
  for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
    const auto [low, high] = std::minmax({rgba[i], rgba[i + 1], rgba[i + 2]});
    if (high - low > max_difference) return true;
  }
  return false;
}

}  // namespace

bool is_grey(const EncodedImage& image) {
  const auto rows = ImageRows::open(image);
  if (rows == nullptr) return !has_coloured_texel(decode_image(image).rgba);
  std::vector<std::uint8_t> row(4 * rows->size().width);
  for (std::uint64_t y = 0; y < rows->size().height; ++y) {
    rows->next(row.data());
    if (has_coloured_texel(row)) return false;
  }
  return true;
}

}  // namespace gigabake
