#include "kernels/cpu/texture/texture.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "core/base/thread_pool.h"
#include "kernels/cpu/texture/texture_halving.h"

namespace gigabake::kernels {
namespace {

/// Halves an image. row_at(y) returns a source row; add(texel, weight, sums) adds one weighted texel to the sums.
template <class RowAt, class Add>
std::vector<std::uint16_t> halve(int width, int height, const ThreadPool& pool, const RowAt& row_at, const Add& add) {
  const int target_width = level_extent(width, 1), target_height = level_extent(height, 1);
  std::vector<std::uint16_t> out(std::size_t(4) * target_width * target_height);
  pool.parallel_for(std::size_t(target_height), 16, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t y = begin; y < end; ++y)
      halve_row({width, height}, int(y), row_at, add, &out[4 * y * std::size_t(target_width)]);
  });
  return out;
}

}  // namespace

int level_count(int width, int height) {
  int levels = 1;
  while (levels < max_texture_levels && (std::max(width, height) >> levels) > 0) ++levels;
  return levels;
}

std::uint8_t effective_cutoff(TextureAlpha alpha, std::uint8_t mask_cutoff) {
  return alpha == TextureAlpha::mask ? std::max<std::uint8_t>(1, mask_cutoff) : std::uint8_t(0);
}

std::uint64_t new_texture_id() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

Texture::Texture(std::vector<std::uint8_t> rgba, int width, int height, TextureAlpha alpha, std::uint8_t mask_cutoff,
                 const ThreadPool& pool, TextureContent content)
    : base_(std::move(rgba)),
      levels_(std::size_t(level_count(width, height))),
      width_(width),
      height_(height),
      mask_cutoff_(effective_cutoff(alpha, mask_cutoff)),
      id_(new_texture_id()) {
  if (alpha == TextureAlpha::ignore) make_opaque(base_.data(), base_.size() / 4);
  is_opaque_ = are_opaque(base_.data(), base_.size() / 4, mask_cutoff_);
  const BaseTexels base_texels(mask_cutoff_, content);
  for (int l = 1; l < int(levels_.size()); ++l) {
    const int from_width = level_extent(width, l - 1), from_height = level_extent(height, l - 1);
    const std::size_t stride = std::size_t(4) * std::size_t(from_width);
    if (l == 1)
      levels_[1] = halve(
          from_width, from_height, pool, [&](std::int64_t y) { return &base_[stride * std::size_t(y)]; }, base_texels);
    else
      levels_[std::size_t(l)] = halve(
          from_width, from_height, pool,
          [&](std::int64_t y) { return &levels_[std::size_t(l - 1)][stride * std::size_t(y)]; }, add_linear_texel);
  }
}

TextureView Texture::view() const {
  TextureView v;
  v.base = base_.data();
  for (std::size_t l = 1; l < levels_.size(); ++l) v.level[l] = levels_[l].data();
  v.width = width_;
  v.height = height_;
  v.levels = int(levels_.size());
  v.mask_cutoff = mask_cutoff_;
  v.is_opaque = is_opaque_;
  v.id = id_;
  return v;
}

std::size_t Texture::bytes() const {
  std::size_t bytes = base_.capacity();
  for (const auto& level : levels_) bytes += level.capacity() * sizeof(std::uint16_t);
  return bytes;
}

}  // namespace gigabake::kernels
