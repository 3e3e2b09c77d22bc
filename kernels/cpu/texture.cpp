#include "kernels/cpu/texture.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "kernels/body/covered_texels.h"
#include "kernels/body/material.h"
#include "kernels/body/tables.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {
namespace {

int level_count(int width, int height) {
  int levels = 1;
  while (levels < max_texture_levels && (std::max(width, height) >> levels) > 0) ++levels;
  return levels;
}

/// Source texels of one target texel along one axis. Weights are in 1/target of a texel and sum to `source`: odd sizes
/// are filtered by exact overlap.
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

/// Halves an image of any texel source: add(x, y, weight, sums).
template <class Add>
std::vector<std::uint16_t> halve(int width, int height, const ThreadPool& pool, const Add& add) {
  const int target_width = level_extent(width, 1), target_height = level_extent(height, 1);
  std::vector<std::uint16_t> out(std::size_t(4) * target_width * target_height);
  const std::uint64_t whole = std::uint64_t(width) * std::uint64_t(height);
  pool.parallel_for(std::size_t(target_height), 16, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t y = begin; y < end; ++y) {
      const Footprint rows(height, target_height, int(y));
      for (int x = 0; x < target_width; ++x) {
        const Footprint columns(width, target_width, x);
        std::uint64_t sum[4] = {0, 0, 0, 0};
        for (std::int64_t j = rows.first; j <= rows.last; ++j)
          for (std::int64_t i = columns.first; i <= columns.last; ++i)
            add(i, j, rows.weight(j) * columns.weight(i), sum);
        for (int c = 0; c < 4; ++c) out[4 * (y * target_width + x) + c] = std::uint16_t((sum[c] + whole / 2) / whole);
      }
    }
  });
  return out;
}

void add_base_texel(const std::uint8_t* p, std::uint8_t mask_cutoff, const Tables& tables, std::uint64_t weight,
                    std::uint64_t sum[4]) {
  const Rgba16 texel = base_texel(p, mask_cutoff, tables.linear_from_srgb);
  for (int c = 0; c < 4; ++c) sum[c] += weight * texel.c[c];
}

}  // namespace

std::uint64_t new_texture_id() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

Texture::Texture(std::vector<std::uint8_t> rgba, int width, int height, TextureAlpha alpha, std::uint8_t mask_cutoff,
                 const ThreadPool& pool)
    : base_(std::move(rgba)),
      levels_(std::size_t(level_count(width, height))),
      width_(width),
      height_(height),
      mask_cutoff_(alpha == TextureAlpha::mask ? std::max<std::uint8_t>(1, mask_cutoff) : std::uint8_t(0)),
      id_(new_texture_id()) {
  if (alpha == TextureAlpha::ignore)
    for (std::size_t i = 3; i < base_.size(); i += 4) base_[i] = 255;
  const Tables tables = TableStore::host().view();
  for (int l = 1; l < int(levels_.size()); ++l) {
    const int from_width = level_extent(width, l - 1), from_height = level_extent(height, l - 1);
    if (l == 1) {
      levels_[1] = halve(
          from_width, from_height, pool, [&](std::int64_t x, std::int64_t y, std::uint64_t weight, std::uint64_t* sum) {
            add_base_texel(&base_[4 * std::size_t(y * from_width + x)], mask_cutoff_, tables, weight, sum);
          });
      continue;
    }
    const std::vector<std::uint16_t>& fine = levels_[std::size_t(l - 1)];
    levels_[std::size_t(l)] = halve(from_width, from_height, pool,
                                    [&](std::int64_t x, std::int64_t y, std::uint64_t weight, std::uint64_t* sum) {
                                      for (int c = 0; c < 4; ++c)
                                        sum[c] += weight * fine[4 * std::size_t(y * from_width + x) + std::size_t(c)];
                                    });
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
  v.id = id_;
  return v;
}

std::size_t Texture::bytes() const {
  std::size_t bytes = base_.capacity();
  for (const auto& level : levels_) bytes += level.capacity() * sizeof(std::uint16_t);
  return bytes;
}

}  // namespace gigabake::kernels
