/// Sampling a texture: which texels, with what weights, and the mean of a footprint's probes.
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "kernels/policy.h"
#include "kernels/shade.h"
#include "kernels/tables.h"
#include "kernels/texture.h"

namespace gigabake::kernels {
namespace {

constexpr Wrap all_wraps[] = {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge};

Texture filled(int size, const std::array<std::uint8_t, 4>& rgba) {
  std::vector<std::uint8_t> texels;
  for (int i = 0; i < size * size; ++i) texels.insert(texels.end(), rgba.begin(), rgba.end());
  return Texture(std::move(texels), size, size, TextureAlpha::blend, 0, CpuPolicy(1));
}

/// `probes` side by side along u, each `texels` wide.
TextureMap map_of(int probes, double texels, int size) {
  TextureMap map{};
  map.su = map.tv = 1.0 / size;
  map.along_u = 1;
  map.probes = probes;
  map.length = texels * probes;
  map.level_texels = texels;
  return map;
}

TEST(Sampling, WrapsTwoNeighboursAsItWrapsEach) {
  constexpr std::uint64_t seed = 41;
  std::mt19937_64 rng(seed);
  for (int i = 0; i < 20000; ++i) {
    const auto size = std::int32_t(1 + rng() % 9);
    const double reach = i % 2 == 0 ? 20 : 1e15;
    const double x0 = std::floor(std::uniform_real_distribution<double>(-reach, reach)(rng));
    for (const Wrap wrap : all_wraps) {
      const TexelPair pair = wrap_pair(x0, size, wrap);
      ASSERT_EQ(pair.a, wrap_texel(std::int64_t(x0), size, wrap)) << x0 << " of " << size << ", seed " << seed;
      ASSERT_EQ(pair.b, wrap_texel(std::int64_t(x0) + 1, size, wrap)) << x0 << " of " << size << ", seed " << seed;
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
      const Rgba16 mean = texture_over(view, material, map_of(probes, texels, size), double(rng() % 100) / 7,
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
  const Texture texture(std::move(texels), 2, 1, TextureAlpha::ignore, 0, CpuPolicy(1));
  const Tables tables = TableStore::host().view();
  for (int step = 0; step <= 256; ++step) {  // from the middle of one to the middle of the other
    const Rgba16 found = sample_level(texture.view(), MaterialView{}, 0, 0.25 + step / 512.0, 0.5, tables);
    ASSERT_EQ(found.c[0], std::uint16_t((std::uint32_t(step) * 65535 * 256 + 32768) >> 16)) << step;
    ASSERT_EQ(found.c[3], 65535);
  }
}

TEST(Sampling, ReadsTheLevelThatAFootprintAsksFor) {
  const Texture texture = filled(64, {1, 2, 3, 255});
  const TextureView view = texture.view();
  const auto blend = [&view](double texels) { return blend_for(view, texels); };
  EXPECT_EQ(blend(1).level, 0);
  EXPECT_EQ(blend(1).count, 1);
  EXPECT_EQ(blend(3).level, 0);  // √3 texels is one bilinear kernel, 2·√3 the next level's
  EXPECT_EQ(blend(3).count, 2);
  EXPECT_EQ(blend(4).level, 1);
  EXPECT_EQ(blend(1e9).level, view.levels - 1);
  EXPECT_EQ(blend(1e9).count, 1);
}

}  // namespace
}  // namespace gigabake::kernels
