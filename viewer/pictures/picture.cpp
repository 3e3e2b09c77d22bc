#include "viewer/pictures/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace gigabake {
namespace {

/// Linear interpolation between two pixels of a row or column. `share` is the weight of the second pixel in 1/256.
struct Between {
  std::size_t first, second;
  unsigned share;
};

std::vector<Between> between(int from, int to) {
  std::vector<Between> all;
  for (int i = 0; i < to; ++i) {
    const double at = std::clamp((i + 0.5) * from / to - 0.5, 0.0, double(from - 1));
    const auto first = std::size_t(at);
    all.push_back({first, std::min(first + 1, std::size_t(from - 1)), unsigned(256 * (at - double(first)))});
  }
  return all;
}

/// Returns the tiles of an image, from its middle outwards.
std::vector<kernels::CastTile> tiles(int width, int height, int tile_width, int tile_height) {
  std::vector<kernels::CastTile> all;
  for (int y = 0; y < height; y += tile_height)
    for (int x = 0; x < width; x += tile_width)
      all.push_back({x, y, std::min(tile_width, width - x), std::min(tile_height, height - y)});
  const auto from_middle = [&](const kernels::CastTile& t) {
    return std::hypot(2.0 * t.x + t.width - width, 2.0 * t.y + t.height - height);
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const auto& a, const auto& b) { return from_middle(a) < from_middle(b); });
  return all;
}

}  // namespace

Picture blank_picture(int width, int height, PictureLight light) {
  Picture picture{width, height, {}};
  const std::size_t pixels = std::size_t(width) * std::size_t(height);
  picture.rgba.resize(4 * pixels);
  picture.depth.resize(pixels);
  if (light == PictureLight::linear_too) picture.linear.resize(4 * pixels);
  return picture;
}

kernels::CastPixels pixels_of(Picture& picture) {
  return {picture.rgba.data(), picture.linear.empty() ? nullptr : picture.linear.data(), picture.depth.data()};
}

Picture enlarged(const Picture& picture, int width, int height, PictureLight light) {
  Picture out = blank_picture(width, height, light);
  const std::vector<Between> columns = between(picture.width, width), rows = between(picture.height, height);
  for (std::size_t y = 0, to = 0; y < rows.size(); ++y)
    for (std::size_t x = 0; x < columns.size(); ++x, ++to) {
      const Between &c = columns[x], &r = rows[y];
      const std::size_t upper = r.first * std::size_t(picture.width), lower = r.second * std::size_t(picture.width);
      const std::uint8_t* corners[4] = {&picture.rgba[4 * (upper + c.first)], &picture.rgba[4 * (upper + c.second)],
                                        &picture.rgba[4 * (lower + c.first)], &picture.rgba[4 * (lower + c.second)]};
      for (std::size_t k = 0; k < 4; ++k) {
        const unsigned above = corners[0][k] * (256 - c.share) + corners[1][k] * c.share;
        const unsigned below = corners[2][k] * (256 - c.share) + corners[3][k] * c.share;
        out.rgba[4 * to + k] = std::uint8_t((above * (256 - r.share) + below * r.share + (1u << 15)) >> 16);
      }
      out.depth[to] = picture.depth[(r.share < 128 ? upper : lower) + (c.share < 128 ? c.first : c.second)];
    }
  return out;
}

std::vector<kernels::CastTile> tiles_of(int width, int height, int edge) { return tiles(width, height, edge, edge); }

std::vector<kernels::CastTile> large_tiles_of(int width, int height, int unit, std::uint64_t max_pixels) {
  const auto units = [&](int pixels) { return std::int64_t(pixels + unit - 1) / unit; };
  const auto count = [](std::int64_t pixels, std::int64_t edge) { return (pixels + edge - 1) / edge; };
  const std::int64_t across = units(width), down = units(height);
  const auto max_units = std::max<std::int64_t>(1, std::int64_t(max_pixels / unsigned(unit) / unsigned(unit)));
  std::array<std::int64_t, 4> best{across * down + 1};  // tiles, size, difference of the edges, width
  for (std::int64_t x = 1; x <= std::min(across, max_units); ++x) {
    // Rows of tiles of equal height leave no thin row at the bottom.
    const std::int64_t rows = count(down, std::min(down, max_units / x)), y = count(down, rows);
    best = std::min(best, {count(across, x) * rows, x * y, std::abs(x - y), x});
  }
  const std::int64_t x = best[3], y = best[1] / x;
  return tiles(width, height, int(x) * unit, int(y) * unit);
}

}  // namespace gigabake
