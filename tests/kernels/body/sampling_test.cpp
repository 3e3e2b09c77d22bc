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

/// Texels a voxel along u and along v of a picture of `size`.
TextureMap map_of(double texels_u, double texels_v, int size) {
  TextureMap map{};
  map.su = texels_u / size;
  map.tv = texels_v / size;
  map.xu = float(texels_u);
  map.yv = float(texels_v);
  return map;
}

/// A box of any size and place; its outline is not looked at.
FragmentShape box_at(double u, double v, float width, float height) {
  return {{u, v}, double(width * height), width * width / 12, 0, height * height / 12, 0, 0, nullptr, nullptr, 0};
}

FragmentShape any_box(std::mt19937_64& rng) {
  return box_at(double(rng() % 100) / 7, double(rng() % 100) / 7, float(rng() % 9) / 8, float(rng() % 9) / 8);
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
    for (int k = 0; k < 8; ++k) {
      const auto texels = [&] { return std::uniform_real_distribution<double>(0, k % 2 == 0 ? 3 : 2.0 * size)(rng); };
      const TextureMap map = map_of(texels(), texels(), size);
      const FragmentShape box = any_box(rng);
      bool rough = true;
      const Rgba16 mean = texture_over<false>(view, material, map, box, tables, rough);
      ASSERT_FALSE(rough) << "texture " << i << ", seed " << seed;
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
  for (int step = 0; step <= 256; ++step) {  // from the middle of one to the middle of the other
    Roughness rough{6};
    const Rgba16 found =
        sample_level<false>(texture.view(), MaterialView{}, 0, fraction_of(0.25 + step / 512.0, Wrap::repeat),
                            fraction_of(0.5, Wrap::repeat), tables, rough);
    ASSERT_TRUE(rough.found);
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
    std::uniform_real_distribution<double> a_voxel(0, 30);
    const TextureMap map = map_of(a_voxel(rng), a_voxel(rng), width);
    const FragmentShape box = any_box(rng);
    bool rough[2];
    const Rgba16 all = texture_over<false>(texture.view(), material, map, box, tables, rough[0]);
    const Rgba16 opaque = texture_over<true>(texture.view(), material, map, box, tables, rough[1]);
    ASSERT_EQ(rough[0], rough[1]);
    for (int c = 0; c < 3; ++c) ASSERT_EQ(opaque.c[c], all.c[c]) << "texture " << i << ", seed " << seed;
    ASSERT_EQ(all.c[3], 65535);
  }
}

/// A probe stands for half of the width, in texels at most as wide; the probes' places and the texels' own width add up
/// to the fragment's variances.
TEST(Sampling, ProbesHaveTheVariancesOfTheFragment) {
  constexpr std::uint64_t seed = 44;
  std::mt19937_64 rng(seed);
  const Texture texture = filled(1024, {1, 2, 3, 255});
  for (int i = 0; i < 2000; ++i) {
    const auto width = [&rng] { return float(std::exp2(std::uniform_real_distribution<double>(-1, 8)(rng))); };
    const float x = width(), y = width();
    const TextureMap map = map_of(x, y, 1024);
    const TexelSpread spread = texel_spread(map, box_at(0.5, 0.5, 1, 1));
    ASSERT_NEAR(spread.longer * 12, std::max(x, y) * std::max(x, y), 1e-4 * spread.longer * 12) << "seed " << seed;
    const Probes probes = probes_for(texture.view(), spread);
    const double texel = std::exp2(probes.level), own = probes.level > 0 ? texel * texel / 4 : 0;
    ASSERT_LE(texel, std::max({1.0, std::min(x, y) / 2.0, std::max(x, y) / 4.0}) * 1.0001);
    ASSERT_LE(probes.along, 8);
    ASSERT_LE(probes.across, 4);
    const auto variance = [](int count, double step_s, double step_t) {
      return std::hypot(step_s, step_t) * std::hypot(step_s, step_t) * 1024 * 1024 * (count * count - 1) / 12;
    };
    ASSERT_NEAR(variance(probes.along, probes.along_s, probes.along_t) + own, spread.longer, 1e-3 * spread.longer);
    const double left = std::max(double(spread.shorter) - own, 0.0);
    ASSERT_NEAR(variance(probes.across, probes.across_s, probes.across_t), left, 1e-3 * spread.shorter);
  }
}

}  // namespace
}  // namespace gigabake::kernels
