/// The prefiltered pyramid: every level has the mean of the image, and its alpha follows the alpha mode of the
/// material.
#include "kernels/cpu/texture/texture.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "core/base/thread_pool.h"
#include "kernels/body/tables.h"

namespace gigabake::kernels {
namespace {

std::vector<std::uint8_t> noise(int width, int height, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::vector<std::uint8_t> rgba(std::size_t(4) * width * height);
  for (auto& c : rgba) c = std::uint8_t(rng());
  return rgba;
}

/// Returns the mean premultiplied linear colour and alpha of the image; 65535 represents 1.
std::array<double, 4> mean_of(const std::vector<std::uint8_t>& rgba, TextureAlpha use, int cutoff) {
  const Tables tables = TableStore::host().view();
  std::array<double, 4> sum{};
  const double texels = double(rgba.size()) / 4;
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    const double alpha = use == TextureAlpha::ignore  ? 1
                         : use == TextureAlpha::blend ? rgba[i + 3] / 255.0
                                                      : double(rgba[i + 3] >= cutoff);
    for (std::size_t c = 0; c < 3; ++c) sum[c] += alpha * tables.linear_from_srgb[rgba[i + c]] / texels;
    sum[3] += alpha * 65535 / texels;
  }
  return sum;
}

class Pyramid : public testing::TestWithParam<TextureAlpha> {};

TEST_P(Pyramid, KeepsTheMeanOfTheImageAtTheTopForAnySize) {
  const ThreadPool pool(2);
  for (const auto& [width, height] : {std::pair{64, 64}, {37, 51}, {1, 9}, {100, 3}, {2, 1}}) {
    const std::uint64_t seed = 6;
    const auto rgba = noise(width, height, seed);
    const Texture texture(rgba, width, height, GetParam(), 128, pool);
    const TextureView view = texture.view();
    ASSERT_EQ(std::max(width, height) >> (view.levels - 1), 1);
    const auto mean = mean_of(rgba, GetParam(), 128);
    for (std::size_t c = 0; c < 4; ++c)  // each level rounds once
      EXPECT_NEAR(view.level[view.levels - 1][c], mean[c], view.levels)
          << width << " × " << height << ", seed " << seed;
  }
}

TEST_P(Pyramid, AveragesTwoByTwoTexels) {
  const auto rgba = noise(2, 2, 7);
  const Texture texture(rgba, 2, 2, GetParam(), 100, ThreadPool(1));
  const auto mean = mean_of(rgba, GetParam(), 100);
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(texture.view().level[1][c], mean[c], 1.0);
}

INSTANTIATE_TEST_SUITE_P(Alpha, Pyramid,
                         testing::Values(TextureAlpha::ignore, TextureAlpha::blend, TextureAlpha::mask));

TEST(Texture, OfOneTexelHasNoPyramid) {
  const Texture texture({10, 20, 30, 40}, 1, 1, TextureAlpha::ignore, 0, ThreadPool(1));
  EXPECT_EQ(texture.view().levels, 1);
  EXPECT_EQ(texture.view().base[3], 255);
}

}  // namespace
}  // namespace gigabake::kernels
