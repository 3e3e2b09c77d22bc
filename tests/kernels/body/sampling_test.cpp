/// Sampling a texture: which texels, with what weights, and the mean of a footprint's probes.
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "kernels/body/shade.h"
#include "kernels/body/tables.h"
#include "kernels/cpu/texture.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {
namespace {

constexpr Wrap all_wraps[] = {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge};

Texture filled(int size, const std::array<std::uint8_t, 4>& rgba) {
  std::vector<std::uint8_t> texels;
  for (int i = 0; i < size * size; ++i) texels.insert(texels.end(), rgba.begin(), rgba.end());
  return Texture(std::move(texels), size, size, TextureAlpha::blend, 0, ThreadPool(1));
}

/// `probes` side by side along u, each `texels` wide.
TextureMap map_of(int probes, double texels, int size) {
  TextureMap map{};
  map.su = map.tv = 1.0 / size;
  map.along_s = map.su;
  set_probes(probes, texels, map);
  return map;
}

/// The texel at whole number i of the endless plane that an image wraps to, by glTF's words.
std::int64_t wrapped(std::int64_t i, std::int64_t size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return std::clamp<std::int64_t>(i, 0, size - 1);
  const std::int64_t period = wrap == Wrap::repeat ? size : 2 * size, r = ((i % period) + period) % period;
  return r < size ? r : period - 1 - r;
}

/// What colour the endless plane has at x texels, where texel i's is i.
double plane_at(double x, std::int64_t size, Wrap wrap) {
  const double below = std::floor(x - 0.5), second = x - 0.5 - below;
  return (1 - second) * double(wrapped(std::int64_t(below), size, wrap)) +
         second * double(wrapped(std::int64_t(below) + 1, size, wrap));
}

TEST(Sampling, WrapsAsTheEndlessPlaneOfTexelsDoes) {
  constexpr std::uint64_t seed = 41;
  std::mt19937_64 rng(seed);
  for (int i = 0; i < 50000; ++i) {
    const auto size = std::uint32_t(1 + rng() % 9);
    const double reach = i % 2 == 0 ? 3 : double(1 << 20);
    double s = std::uniform_real_distribution<double>(-reach, reach)(rng);
    if (i % 5 == 0) s = std::floor(s * size * 2) / (size * 2);  // a texel's middle or border
    for (const Wrap wrap : all_wraps) {
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

/// Weights sum up to one and quotients are exact, whatever the levels and probes: else colours would drift by a code.
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
    for (int probes = 1; probes <= 8; ++probes) {
      const double texels = std::uniform_real_distribution<double>(0, 2.0 * size)(rng);
      const Rgba16 mean = texture_over<false>(view, material, map_of(probes, texels, size), double(rng() % 100) / 7,
                                              double(rng() % 100) / 7, double(rng() % 8) / 4, tables);
      for (int c = 0; c < 4; ++c)
        ASSERT_EQ(mean.c[c], wanted[c]) << "channel " << c << ", " << probes << " probes, texture " << i << ", seed "
                                        << seed;
    }
  }
}

TEST(Sampling, MovesFromOneTexelToTheNextInAStraightLine) {
  std::vector<std::uint8_t> texels;
  for (const int grey : {0, 255}) texels.insert(texels.end(), {std::uint8_t(grey), std::uint8_t(grey), 0, 255});
  const Texture texture(std::move(texels), 2, 1, TextureAlpha::ignore, 0, ThreadPool(1));
  const Tables tables = TableStore::host().view();
  for (int step = 0; step <= 256; ++step) {  // from the middle of one to the middle of the other
    const Rgba16 found =
        sample_level<false>(texture.view(), MaterialView{}, 0, fraction_of(0.25 + step / 512.0, Wrap::repeat),
                            fraction_of(0.5, Wrap::repeat), tables);
    ASSERT_EQ(found.c[0], std::uint16_t((std::uint32_t(step) * 65535 * 256 + 32768) >> 16)) << step;
    ASSERT_EQ(found.c[3], 65535);
  }
}

/// Where alpha is ignored nobody looks at it, and colours are the same.
TEST(Sampling, FindsTheSameColoursWithoutAlpha) {
  constexpr std::uint64_t seed = 43;
  std::mt19937_64 rng(seed);
  const Tables tables = TableStore::host().view();
  for (int i = 0; i < 200; ++i) {
    const int width = 1 + int(rng() % 40), height = 1 + int(rng() % 40);
    std::vector<std::uint8_t> texels(std::size_t(4) * std::size_t(width) * std::size_t(height));
    for (std::uint8_t& x : texels) x = std::uint8_t(rng());
    const Texture texture(std::move(texels), width, height, TextureAlpha::ignore, 0, ThreadPool(1));
    MaterialView material;
    material.wrap_s = all_wraps[rng() % 3];
    material.wrap_t = all_wraps[rng() % 3];
    const double texels_wide = std::uniform_real_distribution<double>(0, 30)(rng);
    const TextureMap map = map_of(1 + int(rng() % 8), texels_wide, width);
    const double u = double(rng() % 1000) / 7, v = double(rng() % 1000) / 7, area = double(rng() % 9) / 8;
    const Rgba16 all = texture_over<false>(texture.view(), material, map, u, v, area, tables);
    const Rgba16 opaque = texture_over<true>(texture.view(), material, map, u, v, area, tables);
    for (int c = 0; c < 3; ++c) ASSERT_EQ(opaque.c[c], all.c[c]) << "texture " << i << ", seed " << seed;
    ASSERT_EQ(all.c[3], 65535);
  }
}

TEST(Sampling, ReadsTheLevelThatAFootprintAsksFor) {
  const Texture texture = filled(64, {1, 2, 3, 255});
  const TextureView view = texture.view();
  const auto blend = [&view](float texels) { return blend_for(view, texels); };
  EXPECT_EQ(blend(1).level, 0);
  EXPECT_EQ(blend(1).coarser, 0u);
  EXPECT_EQ(blend(3).level, 0);  // √3 texels is one bilinear kernel, 2·√3 the next level's
  EXPECT_EQ(blend(3).coarser, std::uint32_t((3 / std::sqrt(3.0) - 1) * 256));
  EXPECT_EQ(blend(4).level, 1);
  EXPECT_EQ(blend(1e9).level, view.levels - 1);
  EXPECT_EQ(blend(1e9).coarser, 0u);
}

}  // namespace
}  // namespace gigabake::kernels
