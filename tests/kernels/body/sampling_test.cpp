/// Texture sampling: the sampled texels, their weights, and the mean over a footprint.
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "core/base/thread_pool.h"
#include "kernels/body/tables.h"
#include "kernels/body/texture/shade.h"
#include "kernels/cpu/texture/texture.h"

namespace gigabake::kernels {
namespace {

constexpr Wrap sampled_wraps[] = {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge};

Texture filled(int size, const std::array<std::uint8_t, 4>& rgba) {
  std::vector<std::uint8_t> texels;
  for (int i = 0; i < size * size; ++i) texels.insert(texels.end(), rgba.begin(), rgba.end());
  return Texture(std::move(texels), size, size, TextureAlpha::blend, 0, ThreadPool(1));
}

/// Returns a random texture whose alpha is ignored.
Texture any_opaque(std::mt19937_64& rng, int width, int height) {
  std::vector<std::uint8_t> texels(std::size_t(4) * std::size_t(width) * std::size_t(height));
  for (std::uint8_t& x : texels) x = std::uint8_t(rng());
  return Texture(std::move(texels), width, height, TextureAlpha::ignore, 0, ThreadPool(1));
}

void wrap_anyhow(std::mt19937_64& rng, MaterialView& material) {
  material.wrap_s = sampled_wraps[rng() % 3];
  material.wrap_t = sampled_wraps[rng() % 3];
}

/// Returns a map with the given numbers of texels per voxel along u and v. The image has `size` texels per edge.
TextureMap map_of(double texels_u, double texels_v, int size) {
  TextureMap map{};
  map.su = texels_u / size;
  map.tv = texels_v / size;
  map.xu = float(texels_u);
  map.yv = float(texels_v);
  return map;
}

/// Returns the fragment of a box with the centre (u, v). Its outline is empty, because the test does not use it.
FragmentShape box_at(double u, double v, double width, double height) {
  return {{u, v}, width * height, float(width * width / 12), 0, float(height * height / 12), 0, 0, nullptr, nullptr, 0};
}

FragmentShape any_fragment(std::mt19937_64& rng) {
  FragmentShape f =
      box_at(double(rng() % 100) / 7, double(rng() % 100) / 7, double(rng() % 9) / 8, double(rng() % 9) / 8);
  f.uv = (float(rng() % 17) / 8 - 1) * std::sqrt(f.uu * f.vv);
  return f;
}

/// Returns the index of the image's texel at position i of an infinite plane, wrapped as glTF defines.
std::int64_t wrapped_texel(std::int64_t i, std::int64_t size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return std::clamp<std::int64_t>(i, 0, size - 1);
  const std::int64_t period = wrap == Wrap::repeat ? size : 2 * size, r = ((i % period) + period) % period;
  return r < size ? r : period - 1 - r;
}

/// Returns the colour at position x, in texels, of the infinite plane that repeats an image in which texel i has the
/// colour i.
double plane_at(double x, std::int64_t size, Wrap wrap) {
  const double below = std::floor(x - 0.5), second = x - 0.5 - below;
  return (1 - second) * double(wrapped_texel(std::int64_t(below), size, wrap)) +
         second * double(wrapped_texel(std::int64_t(below) + 1, size, wrap));
}

TEST(Sampling, WrapsAsTheEndlessPlaneOfTexelsDoes) {
  constexpr std::uint64_t seed = 41;
  std::mt19937_64 rng(seed);
  for (int i = 0; i < 50000; ++i) {
    const auto size = std::uint32_t(1 + rng() % 9);
    const double reach = i % 2 == 0 ? 3 : double(1 << 20);
    double s = std::uniform_real_distribution<double>(-reach, reach)(rng);
    if (i % 5 == 0) s = std::floor(s * size * 2) / (size * 2);  // a texel's middle or border
    for (const Wrap wrap : sampled_wraps) {
      const TexelPair pair = neighbours(fraction_of(s, wrap), size, wrap == Wrap::repeat);
      ASSERT_LT(pair.a, size);
      ASSERT_LT(pair.b, size);
      ASSERT_LE(pair.second, 255u);
      const double found = pair.a + pair.second / 256.0 * (double(pair.b) - double(pair.a));
      ASSERT_NEAR(found, plane_at(s * size, size, wrap), double(size) * (1.0 / 256 + 1e-7))
          << s << " of " << size << " texels, wrap " << int(wrap) << ", seed " << seed;
    }
  }
}

/// The weights of all samples at all levels sum to exactly one. Otherwise a constant colour could change by one code.
TEST(Sampling, FindsOneColourWhereTheTextureHasOne) {
  constexpr std::uint64_t seed = 42;
  std::mt19937_64 rng(seed);
  const Tables tables = TableStore::host().view();
  MaterialView material;
  for (int i = 0; i < 400; ++i) {
    const std::array<std::uint8_t, 4> rgba{std::uint8_t(rng()), std::uint8_t(rng()), std::uint8_t(rng()),
                                           i % 2 == 0 ? std::uint8_t(255) : std::uint8_t(rng())};
    const int size = 1 << rng() % 6;
    const Texture texture = filled(size, rgba);
    const TextureView view = texture.view();
    std::uint16_t wanted[4] = {0, 0, 0, std::uint16_t(rgba[3] * 257)};
    for (std::size_t c = 0; c < 3; ++c) wanted[c] = scale16(tables.linear_from_srgb[rgba[c]], wanted[3]);
    for (int k = 0; k < 8; ++k) {
      std::uniform_real_distribution<double> texels(0, k < 4 ? 4 : 20.0 * size);
      wrap_anyhow(rng, material);
      const TextureMap map = map_of(texels(rng), texels(rng), size);
      const Rgba16 mean = texture_over<false>(view, material, map, any_fragment(rng), tables);
      for (int c = 0; c < 4; ++c)
        ASSERT_EQ(mean.c[c], wanted[c]) << "channel " << c << ", texture " << i << ", seed " << seed;
    }
  }
}

TEST(Sampling, MovesFromOneTexelToTheNextInAStraightLine) {
  std::vector<std::uint8_t> texels;
  for (const int grey : {0, 255}) texels.insert(texels.end(), {std::uint8_t(grey), std::uint8_t(grey), 0, 255});
  const Texture texture(std::move(texels), 2, 1, TextureAlpha::ignore, 0, ThreadPool(1));
  const Tables tables = TableStore::host().view();
  for (int step = 0; step <= 256; ++step) {  // from the middle of one texel to the middle of the other
    const Rgba16 found =
        sample_level<false>(texture.view(), MaterialView{}, 0, fraction_of(0.25 + step / 512.0, Wrap::repeat),
                            fraction_of(0.5, Wrap::repeat), tables);
    ASSERT_EQ(found.c[0], std::uint16_t((std::uint32_t(step) * 65535 * 256 + 32768) >> 16)) << step;
    ASSERT_EQ(found.c[3], 65535);
  }
}

/// The filter does not read alpha if it is ignored, and the colours are the same.
TEST(Sampling, FindsTheSameColoursWithoutAlpha) {
  constexpr std::uint64_t seed = 43;
  std::mt19937_64 rng(seed);
  const Tables tables = TableStore::host().view();
  for (int i = 0; i < 200; ++i) {
    const int width = 1 + int(rng() % 40), height = 1 + int(rng() % 40);
    const Texture texture = any_opaque(rng, width, height);
    MaterialView material;
    wrap_anyhow(rng, material);
    std::uniform_real_distribution<double> wide(0, 30);
    const TextureMap map = map_of(wide(rng), wide(rng), width);
    const FragmentShape f = any_fragment(rng);
    const Rgba16 all = texture_over<false>(texture.view(), material, map, f, tables);
    const Rgba16 opaque = texture_over<true>(texture.view(), material, map, f, tables);
    for (int c = 0; c < 3; ++c) ASSERT_EQ(opaque.c[c], all.c[c]) << "texture " << i << ", seed " << seed;
    ASSERT_EQ(all.c[3], 65535);
  }
}

/// Returns the mean of channel 0 of an opaque texture over a box, computed from 200 × 200 points.
double mean_of_points(const Texture& texture, const MaterialView& m, double s, double t, double width, double height) {
  constexpr int points = 200;
  const Tables tables = TableStore::host().view();
  double sum = 0;
  for (int i = 0; i < points * points; ++i) {
    const double x = s + width * ((i % points + 0.5) / points - 0.5),
                 y = t + height * ((i / points + 0.5) / points - 0.5);
    sum += sample_level<true>(texture.view(), m, 0, fraction_of(x, m.wrap_s), fraction_of(y, m.wrap_t), tables).c[0];
  }
  return sum / (points * points);
}

/// The mean is exact, also across the edges of the image.
TEST(Sampling, HasTheExactMeanOverABoxOfUpToOneTexel) {
  constexpr std::uint64_t seed = 44;
  std::mt19937_64 rng(seed);
  const Tables tables = TableStore::host().view();
  for (int i = 0; i < 40; ++i) {
    const int size = 4 + int(rng() % 9);
    const Texture texture = any_opaque(rng, size, size);
    MaterialView material;
    wrap_anyhow(rng, material);
    std::uniform_real_distribution<double> wide(0, 1), place(-0.4, 1.4);
    const double width = wide(rng) / size, height = wide(rng) / size, s = place(rng), t = place(rng);
    TextureMap map{};
    map.su = map.tv = 1;
    map.xu = map.yv = float(size);
    const Rgba16 found = texture_over<true>(texture.view(), material, map, box_at(s, t, width, height), tables);
    ASSERT_NEAR(found.c[0], mean_of_points(texture, material, s, t, width, height), 400)
        << i << ", " << width * size << " x " << height * size << " texels, seed " << seed;
  }
}

/// Rounding gives a sliver on a voxel's border a positive width, although its centre lies on the border.
TEST(Sampling, OfASliverOnABorderHasAFootprint) {
  const Texture texture = filled(64, {200, 100, 50, 255});
  for (const double texels : {1e3, 1e6, 1e9}) {
    FragmentShape sliver = box_at(0, 0.5, 1, 1e-6);
    sliver.uu = sliver.uv = sliver.vv = 1e-4f;
    const FootprintParts parts = footprint_parts(texture.view(), map_of(texels, 0, 64), sliver);
    EXPECT_GT(parts.columns * parts.rows, 1);
    for (const float x : {parts.part.ss, parts.part.st, parts.part.tt, parts.along_s, parts.along_t, parts.across_s})
      EXPECT_TRUE(std::isfinite(x)) << texels;
    EXPECT_GT(parts.part.ss, 0) << texels;
  }
}

/// The average of the means over two halves equals the mean over the whole, for textures with quadratic colours. This
/// holds only if the mean over a fragment takes its covariance into account.
TEST(Sampling, OfTwoPartsAddsUpToTheWhole) {
  constexpr int size = 64;
  std::vector<std::uint8_t> texels;
  const Tables tables = TableStore::host().view();
  for (int i = 0; i < size * size; ++i) {
    const int x = i % size - 32, y = i / size - 32;
    const auto grey = tables.srgb_from_linear[std::size_t(32768 + 28 * x * y)];
    texels.insert(texels.end(), {grey, grey, grey, 255});
  }
  const Texture texture(std::move(texels), size, size, TextureAlpha::ignore, 0, ThreadPool(1));
  const MaterialView material;
  const TextureMap map = map_of(3, 3, size);
  const auto red = [&](const FragmentShape& f) {
    return double(texture_over<true>(texture.view(), material, map, f, tables).c[0]);
  };
  for (double u = 6; u < 15; u += 0.7) {  // a unit square and its halves on either side of a diagonal
    const double third = 1.0 / 3, v = 21 - u;
    FragmentShape low = box_at(u + 2 * third, v + third, 1, 1), high = box_at(u + third, v + 2 * third, 1, 1);
    low.area = high.area = 0.5;
    low.uu = low.vv = high.uu = high.vv = 1.0f / 18;
    low.uv = high.uv = 1.0f / 36;
    EXPECT_NEAR((red(low) + red(high)) / 2, red(box_at(u + 0.5, v + 0.5, 1, 1)), 200) << u;
  }
}

}  // namespace
}  // namespace gigabake::kernels
