/// The mean of the texels that a fragment covers, if the sampler selects the nearest texel.
#include "kernels/body/texture/nearest_texture.h"

#include <array>
#include <gtest/gtest.h>
#include <random>

#include "core/base/thread_pool.h"
#include "kernels/body/tables.h"
#include "kernels/cpu/texture/texture.h"

namespace gigabake::kernels {
namespace {

constexpr Wrap all_wraps[] = {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge};

Texture random_texture(int width, int height, TextureAlpha alpha, std::mt19937_64& rng) {
  std::vector<std::uint8_t> texels(std::size_t(4) * std::size_t(width) * std::size_t(height));
  for (std::uint8_t& x : texels) x = std::uint8_t(rng());
  return Texture(std::move(texels), width, height, alpha, 128, ThreadPool(1));
}

/// A fragment that covers the whole unit cell.
struct WholeCell {
  double u[4] = {0, 1, 1, 0}, v[4] = {0, 0, 1, 1};
  FragmentShape shape() const { return {{0.5, 0.5}, 1, 1.0f / 12, 0, 1.0f / 12, 0, 0, u, v, 4}; }
};

Rgba16 found(const Texture& texture, const NearestMap& look, const FragmentShape& shape) {
  return nearest_over(texture.view(), look, shape, TableStore::host().view().linear_from_srgb);
}

/// Returns the index of the image's texel at position i of an infinite plane, wrapped as glTF defines.
std::int64_t wrapped(std::int64_t i, std::int64_t size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return std::clamp<std::int64_t>(i, 0, size - 1);
  const std::int64_t period = wrap == Wrap::repeat ? size : 2 * size, r = ((i % period) + period) % period;
  return r < size ? r : period - 1 - r;
}

Rgba16 texel_of(const Texture& texture, std::int64_t x, std::int64_t y) {
  const TextureView view = texture.view();
  return base_texel(view.base + 4 * std::size_t(y * view.width + x), view.mask_cutoff,
                    TableStore::host().view().linear_from_srgb);
}

/// Returns the mean over a box that is parallel to the axes. A texel's weight is the product of its overlaps along x
/// and y.
std::array<double, 4> mean_in_box(const Texture& texture, const NearestMap& look) {
  const TextureView view = texture.view();
  const double x0 = look.s0 * view.width, x1 = x0 + look.su * view.width, y0 = look.t0 * view.height,
               y1 = y0 + look.tv * view.height;
  std::array<double, 4> sum{};
  for (auto y = std::int64_t(std::floor(y0)); double(y) < y1; ++y)
    for (auto x = std::int64_t(std::floor(x0)); double(x) < x1; ++x) {
      const double wide = std::min(x1, double(x + 1)) - std::max(x0, double(x)),
                   high = std::min(y1, double(y + 1)) - std::max(y0, double(y));
      const Rgba16 c = texel_of(texture, wrapped(x, view.width, look.wrap_s), wrapped(y, view.height, look.wrap_t));
      for (std::size_t k = 0; k < 4; ++k) sum[k] += c.c[k] * (wide * high) / ((x1 - x0) * (y1 - y0));
    }
  return sum;
}

TEST(NearestTexels, AreWeighedByTheAreaThatIsCovered) {
  constexpr std::uint64_t seed = 51;
  std::mt19937_64 rng(seed);
  const WholeCell cell;
  for (int i = 0; i < 3000; ++i) {
    const int width = 1 + int(rng() % 20), height = 1 + int(rng() % 20);
    const Texture texture = random_texture(width, height, i % 2 == 0 ? TextureAlpha::blend : TextureAlpha::mask, rng);
    const auto unit = [&rng] { return std::uniform_real_distribution<double>(0, 1)(rng); };
    const double reach = i % 3 == 0 ? 3 : 1000;
    const NearestMap look{reach * (2 * unit() - 1),
                          (0.01 + 6.9 * unit()) / width,
                          0,
                          reach * (2 * unit() - 1),
                          0,
                          (0.01 + 6.9 * unit()) / height,
                          all_wraps[rng() % 3],
                          all_wraps[rng() % 3]};
    const Rgba16 mean = found(texture, look, cell.shape());
    const std::array<double, 4> wanted = mean_in_box(texture, look);
    for (std::size_t c = 0; c < 4; ++c)
      ASSERT_NEAR(mean.c[c], wanted[c], 0.6) << "channel " << c << ", texture " << i << ", seed " << seed;
  }
}

TEST(NearestTexels, AreOneColourWhereTheTextureHasOne) {
  constexpr std::uint64_t seed = 52;
  std::mt19937_64 rng(seed);
  const WholeCell cell;
  for (int i = 0; i < 500; ++i) {
    const int size = 1 << rng() % 6;
    std::vector<std::uint8_t> texels;
    for (int k = 0; k < size * size; ++k)
      texels.insert(texels.end(), {200, 100, 7, std::uint8_t(i % 2 == 0 ? 255 : 90)});
    const Texture texture(std::move(texels), size, size, TextureAlpha::blend, 0, ThreadPool(1));
    const Rgba16 wanted = texel_of(texture, 0, 0);
    const double reach = std::pow(10.0, std::uniform_real_distribution<double>(-12, 12)(rng));
    const auto any = [&rng, reach] { return std::uniform_real_distribution<double>(-reach, reach)(rng); };
    const Rgba16 mean = found(
        texture, {any(), any(), any(), any(), any(), any(), all_wraps[rng() % 3], all_wraps[rng() % 3]}, cell.shape());
    for (int c = 0; c < 4; ++c) ASSERT_EQ(mean.c[c], wanted.c[c]) << "channel " << c << ", seed " << seed;
  }
}

/// Returns black, white, black and white columns.
Texture stripes() {
  std::vector<std::uint8_t> texels;
  for (const int grey : {0, 255, 0, 255})
    texels.insert(texels.end(), {std::uint8_t(grey), std::uint8_t(grey), std::uint8_t(grey), 255});
  return Texture(std::move(texels), 4, 1, TextureAlpha::blend, 0, ThreadPool(1));
}

TEST(NearestTexels, AreOneForATriangleThatLiesOnOnePointOfTheTexture) {
  const WholeCell cell;
  EXPECT_EQ(found(stripes(), {0.3, 0, 0, 0.7, 0, 0, Wrap::repeat, Wrap::repeat}, cell.shape()).c[0], 65535);
  EXPECT_EQ(found(stripes(), {0.25, 0, 0, 0.7, 0, 0, Wrap::repeat, Wrap::repeat}, cell.shape()).c[0], 65535);
  EXPECT_EQ(found(stripes(), {0.2, 0, 0, 0.7, 0, 0, Wrap::repeat, Wrap::repeat}, cell.shape()).c[0], 0);
}

TEST(NearestTexels, AreAMeanAlongTheLineThatATriangleLiesOn) {
  const WholeCell cell;  // the line is half a texel long; a quarter of it is in the first texel
  const Rgba16 along_u =
      found(stripes(), {0.25 - 1.0 / 32, 0.125, 0, 0.5, 0, 0, Wrap::repeat, Wrap::repeat}, cell.shape());
  EXPECT_NEAR(along_u.c[0], 0.75 * 65535, 1);
  const Rgba16 along_v =
      found(stripes(), {0.25 - 1.0 / 32, 0, 0.125, 0.5, 0, 0, Wrap::repeat, Wrap::repeat}, cell.shape());
  EXPECT_NEAR(along_v.c[0], 0.75 * 65535, 1);
}

/// A degenerate triangle may read any texel, but never memory beyond the image.
TEST(NearestTexels, AreOfTheImageWhateverIsAskedFor) {
  constexpr std::uint64_t seed = 53;
  std::mt19937_64 rng(seed);
  const Texture texture = random_texture(37, 5, TextureAlpha::blend, rng);
  for (int i = 0; i < 20000; ++i) {
    const auto any = [&rng] {
      return std::pow(10.0, std::uniform_real_distribution<double>(-40, 26)(rng)) * (rng() % 2 == 0 ? 1 : -1);
    };
    WholeCell cell;
    if (i % 2 == 0)
      for (double& x : cell.u) x = any();
    const Rgba16 r =
        found(texture, {any(), any(), any(), any(), any(), any(), all_wraps[rng() % 3], all_wraps[rng() % 3]},
              {{0.5, 0.5}, i % 3 == 0 ? any() : 1, 0, 0, 0, 0, 0, cell.u, cell.v, 4});
    for (int c = 0; c < 3; ++c) ASSERT_LE(r.c[c], r.c[3] + 2) << "seed " << seed;
  }
}

/// The polygon covers half of the cell and extends beyond the cell on three sides.
TEST(NearestTexels, AreThoseOfTheFragmentNotOfItsCell) {
  const double u[3] = {0.5, 40, 0.5}, v[3] = {-30, -30, 70};  // a polygon that begins at u = 1/2
  const FragmentShape shape{{0.75, 0.5}, 0.5, 0, 0, 0, 0, 0, u, v, 3};
  const NearestMap look{0, 0.5, 0, 0.5, 0, 0.1, Wrap::repeat, Wrap::repeat};  // two texels per voxel
  EXPECT_EQ(found(stripes(), look, shape).c[0], 65535);
}

}  // namespace
}  // namespace gigabake::kernels
