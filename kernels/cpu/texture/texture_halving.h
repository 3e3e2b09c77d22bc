/// The computation of a texture's next coarser level, row by row.
///
/// Exact   Integers: the result does not depend on whether the source level is processed as a whole or in parts.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "kernels/body/tables.h"
#include "kernels/body/texture/nearest_texture.h"
#include "kernels/body/texture/texture_view.h"
#include "kernels/cpu/texture/texture.h"

namespace gigabake::kernels {

struct LevelExtent {
  int width, height;
};

/// The source texels that one target texel covers along one axis. A weight is the exact overlap in units of 1/target
/// source texel. The weights sum to `source`.
struct Footprint {
  std::int64_t first, last;
  std::int64_t source, target, at;

  Footprint(int source_size, int target_size, int x)
      : first(std::int64_t(x) * source_size / target_size),
        last(((std::int64_t(x) + 1) * source_size - 1) / target_size),
        source(source_size),
        target(target_size),
        at(x) {}
  std::uint64_t weight(std::int64_t i) const {
    return std::uint64_t(std::min((i + 1) * target, (at + 1) * source) - std::max(i * target, at * source));
  }
};

/// Computes row `y` like halve_row() from a level with an even number of rows and columns. All weights are equal there.
template <class RowAt, class Add>
void halve_even_row(int target_width, int y, const RowAt& row_at, const Add& add, std::uint16_t* out) {
  const auto *upper = row_at(2 * std::int64_t(y)), *lower = row_at(2 * std::int64_t(y) + 1);
  for (int x = 0; x < target_width; ++x) {
    std::uint64_t sum[4] = {2, 2, 2, 2};
    for (const auto* texel : {upper + 8 * std::size_t(x), lower + 8 * std::size_t(x)}) {
      add(texel, 1, sum);
      add(texel + 4, 1, sum);
    }
    for (int c = 0; c < 4; ++c) out[4 * std::size_t(x) + std::size_t(c)] = std::uint16_t(sum[c] / 4);
  }
}

/// Computes row `y` of the next coarser level. The call row_at(j) returns row j of the source, with 4 values per texel.
/// The call add(texel, weight, sums) adds a weighted texel to the sums. `out` receives 4 values per texel of the row.
template <class RowAt, class Add>
void halve_row(LevelExtent from, int y, const RowAt& row_at, const Add& add, std::uint16_t* out) {
  const int target_width = level_extent(from.width, 1);
  if (from.width % 2 == 0 && from.height % 2 == 0) return halve_even_row(target_width, y, row_at, add, out);
  const std::uint64_t whole = std::uint64_t(from.width) * std::uint64_t(from.height);
  const Footprint rows(from.height, level_extent(from.height, 1), y);
  for (int x = 0; x < target_width; ++x) {
    const Footprint columns(from.width, target_width, x);
    std::uint64_t sum[4] = {0, 0, 0, 0};
    for (std::int64_t j = rows.first; j <= rows.last; ++j)
      for (std::int64_t i = columns.first; i <= columns.last; ++i)
        add(row_at(j) + 4 * i, rows.weight(j) * columns.weight(i), sum);
    for (int c = 0; c < 4; ++c) out[4 * std::size_t(x) + std::size_t(c)] = std::uint16_t((sum[c] + whole / 2) / whole);
  }
}

/// A functor that adds texels of level 0 to sums, as linear premultiplied values. If there is an alpha test, each texel
/// counts as opaque or transparent.
class BaseTexels {
 public:
  BaseTexels(std::uint8_t mask_cutoff, TextureContent content)
      : mask_cutoff_(mask_cutoff), linear_from_code_(table_of(TableStore::host().view(), content)) {}
  void operator()(const std::uint8_t* p, std::uint64_t weight, std::uint64_t sum[4]) const {
    const Rgba16 texel = base_texel(p, mask_cutoff_, linear_from_code_);
    for (int c = 0; c < 4; ++c) sum[c] += weight * texel.c[c];
  }

 private:
  static const std::uint16_t* table_of(const Tables& tables, TextureContent content) {
    return content == TextureContent::directions ? tables.linear_from_code : tables.linear_from_srgb;
  }

  const std::uint8_t mask_cutoff_;
  const std::uint16_t* const linear_from_code_;
};

/// Adds a weighted texel of level 1 or coarser to the sums.
inline void add_linear_texel(const std::uint16_t* p, std::uint64_t weight, std::uint64_t sum[4]) {
  for (int c = 0; c < 4; ++c) sum[c] += weight * p[c];
}

/// Sets the alpha of all texels to 255, as TextureAlpha::ignore requires.
inline void make_opaque(std::uint8_t* rgba, std::size_t texels) {
  for (std::size_t i = 0; i < texels; ++i) rgba[4 * i + 3] = 255;
}

/// Returns true if all texels pass the alpha test; a cutoff of 0 is no test and requires alpha 255.
inline bool are_opaque(const std::uint8_t* rgba, std::size_t texels, std::uint8_t mask_cutoff) {
  const std::uint8_t minimum = mask_cutoff == 0 ? 255 : mask_cutoff;
  for (std::size_t i = 0; i < texels; ++i)
    if (rgba[4 * i + 3] < minimum) return false;
  return true;
}

}  // namespace gigabake::kernels
