/// Textures on voxels compared with brute force: dense samples of the bilinear or nearest texel over the voxel's
/// surface. Bounds: docs/accuracy-images.md.
#include <gtest/gtest.h>

#include "bake_scene.h"
#include "core/base/rules.h"
#include "triangle_families.h"

namespace gigabake::reference {
namespace {

using namespace gigabake::kernels;

constexpr int sheet_voxels = 16;

struct Picture {
  int width, height;
  std::vector<std::uint8_t> rgba;
};

using Linear = std::array<double, 4>;  ///< premultiplied

std::int64_t wrapped(std::int64_t i, std::int64_t size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return std::clamp<std::int64_t>(i, 0, size - 1);
  const std::int64_t period = wrap == Wrap::repeat ? size : 2 * size;
  const std::int64_t r = ((i % period) + period) % period;
  return r < size ? r : period - 1 - r;
}

double linear_of_code(std::uint8_t code) {
  static const std::vector<double> table = [] {
    std::vector<double> t;
    for (int i = 0; i < 256; ++i) t.push_back(linear_of(i / 255.0));
    return t;
  }();
  return table[code];
}

Linear texel(const Picture& p, std::int64_t x, std::int64_t y, const MaterialView& m) {
  const std::uint8_t* c =
      &p.rgba[4 * std::size_t(wrapped(y, p.height, m.wrap_t) * p.width + wrapped(x, p.width, m.wrap_s))];
  const double alpha = m.alpha_mode == AlphaMode::opaque ? 1 : c[3] / 255.0;
  return {alpha * linear_of_code(c[0]), alpha * linear_of_code(c[1]), alpha * linear_of_code(c[2]), alpha};
}

Linear bilinear(const Picture& p, double s, double t, const MaterialView& m) {
  const double x = s * p.width - 0.5, y = t * p.height - 0.5, fx = x - std::floor(x), fy = y - std::floor(y);
  const auto ix = std::int64_t(std::floor(x)), iy = std::int64_t(std::floor(y));
  Linear sum{};
  for (int k = 0; k < 4; ++k) {
    const double w = (k & 1 ? fx : 1 - fx) * (k & 2 ? fy : 1 - fy);
    const Linear c = texel(p, ix + (k & 1), iy + (k >> 1), m);
    for (int i = 0; i < 4; ++i) sum[i] += w * c[i];
  }
  if (m.alpha_mode != AlphaMode::mask) return sum;
  if (sum[3] < 0.5) return {};
  return {sum[0] / sum[3], sum[1] / sum[3], sum[2] / sum[3], 1};
}

Linear nearest(const Picture& p, double s, double t, const MaterialView& m) {
  const Linear c = texel(p, std::int64_t(std::floor(s * p.width)), std::int64_t(std::floor(t * p.height)), m);
  if (m.alpha_mode != AlphaMode::mask) return c;
  if (c[3] < 0.5) return {};
  return {c[0] / c[3], c[1] / c[3], c[2] / c[3], 1};
}

/// Texture coordinates as an affine map of positions on the square, in voxels.
struct Mapping {
  double s0, sx, sy, t0, tx, ty;
  double s(double x, double y) const { return s0 + sx * x + sy * y; }
  double t(double x, double y) const { return t0 + tx * x + ty * y; }
};

Linear supersampled(const Picture& p, const MaterialView& m, const Mapping& map, int i, int j) {
  const int samples = m.nearest ? 144 : 48;  // nearest sampling has sharp borders
  Linear sum{};
  for (int b = 0; b < samples; ++b)
    for (int a = 0; a < samples; ++a) {
      const double x = i + (a + 0.5) / samples, y = j + (b + 0.5) / samples;
      const Linear c = (m.nearest ? nearest : bilinear)(p, map.s(x, y), map.t(x, y), m);
      for (int k = 0; k < 4; ++k) sum[k] += c[k] / (samples * samples);
    }
  return sum;
}

/// Returns the colours of all voxels of the square, row by row.
std::vector<Linear> supersampled_sheet(const Picture& picture, const MaterialView& material, const Mapping& map) {
  std::vector<Linear> out;
  for (int j = 0; j < sheet_voxels; ++j)
    for (int i = 0; i < sheet_voxels; ++i) out.push_back(supersampled(picture, material, map, i, j));
  return out;
}

/// Returns a square of 16 × 16 voxels in the middle of a layer of voxels.
std::vector<Triangle> sheet() {
  const std::int64_t e = sheet_voxels * 256;
  return {{{{0, 0, 128}, {e, 0, 128}, {e, e, 128}}}, {{{0, 0, 128}, {e, e, 128}, {0, e, 128}}}};
}

/// Returns true if a, b, c turn left, seen from above.
bool turns_left(const LatticeVertex& a, const LatticeVertex& b, const LatticeVertex& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]);
}

/// Returns the square cut into at least `count` triangles. Random triangles are split in three at an inner point.
std::vector<Triangle> cut_sheet(std::size_t count, Rng& rng) {
  std::vector<Triangle> all = sheet();
  while (all.size() < count) {
    Triangle& t = all[std::size_t(uniform(rng, 0, std::int64_t(all.size()) - 1))];
    const std::int64_t b = uniform(rng, 1, 998), c = uniform(rng, 1, 999 - b), a = 1000 - b - c;
    const LatticeVertex inside = (t[0] * a + t[1] * b + t[2] * c) / 1000;
    if (!turns_left(t[0], t[1], inside) || !turns_left(t[1], t[2], inside) || !turns_left(t[2], t[0], inside)) continue;
    const Triangle other[2] = {{{t[1], t[2], inside}}, {{t[2], t[0], inside}}};
    t[2] = inside;
    all.insert(all.end(), std::begin(other), std::end(other));
  }
  return all;
}

VoxelMap baked_sheet(const Picture& picture, const MaterialView& material, const Mapping& map,
                     const std::vector<Triangle>& triangles) {
  BakeScene scene;
  scene.set_window({0, 0, 0}, sheet_voxels);
  Part& part = scene.add_mesh(triangles, scene.add_textured(material, picture.rgba, picture.width, picture.height));
  for (std::size_t v = 0; v < 3 * triangles.size(); ++v) {
    const double x = part.position[3 * v] / 256, y = part.position[3 * v + 1] / 256;
    part.uv.insert(part.uv.end(), {float(map.s(x, y)), float(map.t(x, y))});
  }
  return voxels_at(scene.bake(), scene.parameters, 0);
}

struct Errors {
  double worst = 0, mean = 0;  ///< of premultiplied linear colour and alpha, 0 … 1
  double worst_alpha = 0;
  double bias[4] = {0, 0, 0, 0};  ///< mean signed error
};

Errors errors_of(const VoxelMap& voxels, const std::vector<Linear>& expected) {
  Errors e;
  for (int j = 0; j < sheet_voxels; ++j)
    for (int i = 0; i < sheet_voxels; ++i) {
      const auto found = voxels.find({i, j, 0});
      const BakedVoxel v = found == voxels.end() ? BakedVoxel{} : found->second;
      for (std::size_t c = 0; c < 4; ++c) {
        const double alpha = v.rgba[3] / 255.0, value = c == 3 ? alpha : alpha * linear_of_code(v.rgba[c]);
        const double error = value - expected[std::size_t(sheet_voxels * j + i)][c];
        e.worst = std::max(e.worst, std::abs(error));
        if (c == 3) e.worst_alpha = std::max(e.worst_alpha, std::abs(error));
        e.mean += std::abs(error) / (4 * sheet_voxels * sheet_voxels);
        e.bias[c] += error / (sheet_voxels * sheet_voxels);
      }
    }
  return e;
}

Picture noise(int width, int height, Rng& rng, int darkest = 0, int brightest = 255) {
  Picture p{width, height, std::vector<std::uint8_t>(std::size_t(4 * width * height))};
  for (auto& c : p.rgba) c = std::uint8_t(uniform(rng, darkest, brightest));
  return p;
}

/// Returns sine waves of about 16 texels. Adjacent texels are similar, as in photographs, also if the image repeats.
Picture waves(int width, int height) {
  Picture p{width, height, {}};
  const double turn = 2 * std::numbers::pi, a = turn * (width / 16) / width, b = turn * (height / 20) / height;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 4; ++c) p.rgba.push_back(std::uint8_t(127.5 + 127 * std::sin(a * x + b * y + c)));
  return p;
}

struct Case {
  const char* name;
  bool is_noise;
  int width, height;
  MaterialView material;
  Mapping map;  ///< from positions on the square in voxels
  double worst, mean, bias;
  double worst_cut = 0;  ///< `worst` for the square cut into 1,000 triangles; 0: equal to `worst`
};

MaterialView with(AlphaMode mode, Wrap s = Wrap::repeat, Wrap t = Wrap::repeat) {
  MaterialView m;
  m.alpha_mode = mode;
  m.wrap_s = s;
  m.wrap_t = t;
  return m;
}

MaterialView nearest_of(MaterialView m) {
  m.nearest = true;
  return m;
}

/// Returns a map with n texels per voxel along both axes of an image with `size` texels along an edge.
Mapping scaled(double n, double size) { return {0.013, n / size, 0, 0.029, 0, n / size}; }

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

std::vector<Case> texture_cases() {
  const auto opaque = with(AlphaMode::opaque), blend = with(AlphaMode::blend), mask = with(AlphaMode::mask);
  const auto sharp = nearest_of(opaque), sharp_blend = nearest_of(blend), sharp_mask = nearest_of(mask);
  const auto mirror = with(AlphaMode::opaque, Wrap::mirrored_repeat, Wrap::mirrored_repeat);
  const auto clamp = with(AlphaMode::opaque, Wrap::clamp_to_edge, Wrap::clamp_to_edge);
  const double r = std::sqrt(0.5) * 4 / 64;
  const Mapping odd{0, 5 / 37.0, 0, 0, 0, 5 / 51.0}, turned{0, r, -r, 0, r, r},
      stretched{0, 6 / 64.0, 0, 0, 0, 1 / 64.0};
  const Mapping oblique{0, 10 / 128.0, 10 / 128.0, 0, -0.5 / 128, 0.5 / 128},
      over{-0.4, 3 / 32.0, 0, -0.4, 0, 3 / 32.0};
  return {
      {"magnified_8", true, 64, 64, opaque, scaled(0.125, 64), 0.006, 0.001, 0.001},
      {"one_texel_a_voxel", false, 64, 64, opaque, scaled(1, 64), 0.006, 0.001, 0.001},
      {"minified_2", false, 64, 64, opaque, scaled(2, 64), 0.009, 0.0019, 0.001},
      {"minified_3", false, 64, 64, opaque, scaled(3, 64), 0.025, 0.0016, 0.001},
      {"minified_8", true, 128, 128, opaque, scaled(8, 128), 0.055, 0.0085, 0.0015},
      {"minified_11_blend", true, 256, 256, blend, scaled(11, 256), 0.064, 0.01, 0.0015},
      {"minified_40", true, 256, 256, opaque, scaled(40, 256), 0.023, 0.0036, 0.001},
      {"odd_size", true, 37, 51, blend, odd, 0.057, 0.0067, 0.0015},
      {"turned_45_degrees", false, 64, 64, opaque, turned, 0.028, 0.0027, 0.001},
      {"stretched_6", false, 64, 64, opaque, stretched, 0.042, 0.0021, 0.001},
      {"stretched_20_oblique", false, 128, 128, opaque, oblique, 0.085, 0.03, 0.0022},
      {"mirrored_repeat", false, 32, 32, mirror, scaled(3, 32), 0.024, 0.0014, 0.001},
      {"clamp_to_edge", false, 32, 32, clamp, over, 0.021, 0.0013, 0.001},
      {"mask_magnified", true, 64, 64, mask, scaled(0.25, 64), 0.11, 0.004, 0.004},
      {"mask_minified", false, 64, 64, mask, scaled(4, 64), 0.118, 0.0127, 0.0035},
      {"nearest_magnified_8", true, 64, 64, sharp, scaled(0.125, 64), 0.008, 0.0003, 0.0005},
      {"nearest_one_texel_a_voxel", true, 64, 64, sharp, scaled(1, 64), 0.007, 0.0012, 0.0005},
      {"nearest_1_5_texels_a_voxel", true, 64, 64, sharp_blend, scaled(1.5, 64), 0.007, 0.0012, 0.0005},
      {"nearest_minified_2", true, 64, 64, sharp, scaled(2, 64), 0.007, 0.0013, 0.0005},
      {"nearest_minified_5", true, 128, 128, sharp_blend, scaled(5, 128), 0.007, 0.0014, 0.0005},
      {"nearest_minified_11", true, 256, 256, sharp, scaled(11, 256), 0.026, 0.005, 0.0005, 0.042},
      {"nearest_minified_40", true, 256, 256, sharp, scaled(40, 256), 0.013, 0.0025, 0.0005},
      {"nearest_odd_size", true, 37, 51, sharp_blend, odd, 0.007, 0.0014, 0.0005},
      {"nearest_turned_45_degrees", true, 64, 64, sharp, turned, 0.007, 0.0012, 0.0005},
      {"nearest_stretched_6", true, 64, 64, sharp, stretched, 0.007, 0.0012, 0.0005},
      {"nearest_stretched_20_oblique", true, 128, 128, sharp, oblique, 0.013, 0.002, 0.0005},
      {"nearest_mirrored_repeat", true, 32, 32, nearest_of(mirror), scaled(3, 32), 0.007, 0.0013, 0.0005},
      {"nearest_clamp_to_edge", true, 32, 32, nearest_of(clamp), over, 0.007, 0.0014, 0.0005},
      {"nearest_mask_magnified", true, 64, 64, sharp_mask, scaled(0.25, 64), 0.005, 0.0005, 0.0005},
      {"nearest_mask_1_5", true, 64, 64, sharp_mask, scaled(1.5, 64), 0.006, 0.0012, 0.0005},
      {"nearest_mask_minified_11", true, 128, 128, sharp_mask, scaled(11, 128), 0.045, 0.0075, 0.0005, 0.05},
  };
}

class Textures : public testing::TestWithParam<Case> {};

TEST_P(Textures, AreAsBruteForceHasThemWithinTheStatedBound) {
  const Case& c = GetParam();
  const std::uint64_t seed = 111;
  Rng rng(seed);
  const Picture picture = c.is_noise ? noise(c.width, c.height, rng) : waves(c.width, c.height);
  const std::vector<Linear> expected = supersampled_sheet(picture, c.material, c.map);
  for (const bool cut : {false, true}) {
    const Errors e = errors_of(baked_sheet(picture, c.material, c.map, cut ? cut_sheet(1000, rng) : sheet()), expected);
    RecordProperty(cut ? "worst_cut" : "worst", std::to_string(e.worst));
    RecordProperty(cut ? "mean_cut" : "mean", std::to_string(e.mean));
    RecordProperty(cut ? "bias_cut" : "bias",
                   std::to_string(std::abs(*std::max_element(
                       e.bias, e.bias + 4, [](double a, double b) { return std::abs(a) < std::abs(b); }))));
    EXPECT_LE(e.worst, cut && c.worst_cut != 0 ? c.worst_cut : c.worst) << (cut ? "cut, " : "whole, ") << seed;
    EXPECT_LE(e.mean, c.mean) << (cut ? "cut, " : "whole, ") << seed;
    for (const double bias : e.bias) EXPECT_LE(std::abs(bias), c.bias) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, Textures, testing::ValuesIn(texture_cases()),
                         [](const auto& row) { return std::string(row.param.name); });

TEST(ConstantTexture, IsItsColourAtEveryScaleExactly) {
  Picture picture{24, 40, {}};
  for (int i = 0; i < 24 * 40; ++i) picture.rgba.insert(picture.rgba.end(), {200, 100, 7, 255});
  for (const double n : {0.01, 0.7, 1.0, 3.3, 17.0, 200.0}) {
    const VoxelMap voxels = baked_sheet(picture, with(AlphaMode::blend), scaled(n, 24), sheet());
    ASSERT_EQ(voxels.size(), std::size_t(sheet_voxels * sheet_voxels));
    for (const auto& [p, v] : voxels) ASSERT_EQ(v.rgba, (std::array<std::uint8_t, 4>{200, 100, 7, 255})) << n;
  }
}

TEST(NearestTexture, IsTheTexelItselfWhereAVoxelLiesInOne) {
  Rng rng(112);
  const Picture picture = noise(4, 4, rng);
  const MaterialView nearest = nearest_of(with(AlphaMode::opaque));
  for (const auto& [p, v] : baked_sheet(picture, nearest, {0, 1 / 16.0, 0, 0, 0, 1 / 16.0}, sheet()))
    for (int c = 0; c < 3; ++c) ASSERT_EQ(v.rgba[c], picture.rgba[4 * std::size_t(p[1] / 4 * 4 + p[0] / 4) + c]);
}

/// Maximum differences between two bakes of a square that is cut in two ways.
struct Difference {
  int colour = 0, alpha = 0;  ///< codes
};

Difference between(const VoxelMap& a, const VoxelMap& b) {
  Difference maximum;
  for (const auto& [p, v] : a) {
    const auto other = b.find(p);
    const std::array<std::uint8_t, 4> rgba = other == b.end() ? std::array<std::uint8_t, 4>{} : other->second.rgba;
    maximum.alpha = std::max(maximum.alpha, std::abs(int(v.rgba[3]) - int(rgba[3])));
    for (std::size_t c = 0; c < 3 && v.rgba[3] > 32 && rgba[3] > 32; ++c)
      maximum.colour = std::max(maximum.colour, std::abs(int(v.rgba[c]) - int(rgba[c])));
  }
  return maximum;
}

struct Sheet {
  const char* name;
  Picture picture;
  double texels;  ///< per voxel
  int codes;      ///< max difference of colours, and of alphas of blended materials
  double tested;  ///< max error of alpha under an alpha test, 0 … 1
};

/// Returns squares with uneven textures. Each voxel of the first square shows the whole image.
std::vector<Sheet> uneven_sheets(Rng& rng) {
  return {{"noise of 4 x 4", noise(4, 4, rng), 4, 40, 0.6},
          {"noise", noise(64, 64, rng), 0.25, 3, 0.11},
          {"noise", noise(64, 64, rng), 1, 3, 0.56},
          {"noise", noise(64, 64, rng), 2, 46, 0.5},
          {"noise", noise(64, 64, rng), 5, 28, 0.25},
          {"faint noise", noise(64, 64, rng, 208, 254), 1, 3, 0.02},
          {"faint noise", noise(64, 64, rng, 208, 254), 2, 10, 0.02},
          {"faint noise", noise(64, 64, rng, 208, 254), 3.4, 7, 0.02},
          {"faint noise", noise(64, 64, rng, 208, 254), 7, 6, 0.02},
          {"waves", waves(64, 64), 1, 3, 0.11},
          {"waves", waves(64, 64), 3, 8, 0.13},
          {"waves", waves(64, 64), 8, 33, 0.137}};
}

TEST(Texture, DoesNotShowHowItsSheetIsCutIntoTriangles) {
  const std::uint64_t seed = 114;
  Rng rng(seed);
  for (const Sheet& s : uneven_sheets(rng))
    for (const AlphaMode mode : {AlphaMode::opaque, AlphaMode::blend}) {
      const Mapping map = scaled(s.texels, s.picture.width);
      const VoxelMap two = baked_sheet(s.picture, with(mode), map, sheet());
      for (const std::size_t triangles : {8u, 1000u}) {
        const Difference d = between(two, baked_sheet(s.picture, with(mode), map, cut_sheet(triangles, rng)));
        RecordProperty(s.name + ("_" + std::to_string(s.texels).substr(0, 4)) + "_" + std::to_string(triangles) +
                           (mode == AlphaMode::opaque ? "_opaque" : "_blend"),
                       std::max(d.colour, d.alpha));
        EXPECT_LE(d.colour, s.codes) << s.name << ", " << s.texels << " texels a voxel, " << triangles
                                     << " triangles, seed " << seed;
        EXPECT_LE(d.alpha, s.codes) << s.name << ", " << s.texels << " texels a voxel, " << triangles
                                    << " triangles, seed " << seed;
      }
    }
}

TEST(Texture, OfAnAlphaTestCoversWhatItShouldWithinTheStatedBound) {
  const std::uint64_t seed = 115;
  Rng rng(seed);
  for (const Sheet& s : uneven_sheets(rng)) {
    const MaterialView mask = with(AlphaMode::mask);
    const Mapping map = scaled(s.texels, s.picture.width);
    const std::vector<Linear> expected = supersampled_sheet(s.picture, mask, map);
    for (const std::size_t triangles : {2u, 1000u}) {
      const Errors e = errors_of(baked_sheet(s.picture, mask, map, cut_sheet(triangles, rng)), expected);
      RecordProperty(s.name + ("_" + std::to_string(s.texels).substr(0, 4)) + "_" + std::to_string(triangles),
                     std::to_string(e.worst_alpha));
      EXPECT_LE(e.worst_alpha, s.tested) << s.name << ", " << s.texels << " texels a voxel, " << triangles
                                         << " triangles, seed " << seed;
    }
  }
}

/// A green chart in the corner of a red image is sampled up to half a texel from the red texels. Within this limit,
/// bilinear sampling reads no red.
TEST(Texture, OfAChartHasLittleOfItsNeighbours) {
  const std::uint64_t seed = 116;
  Rng rng(seed);
  const struct { int texels, codes; } bounds[] = {{1, 8}, {3, 11}, {8, 32}, {16, 52}};
  for (const auto& [texels, codes] : bounds) {
    const int chart = sheet_voxels * texels + 1, size = 2 * chart + 5;
    Picture picture{size, size, {}};
    for (int i = 0; i < size * size; ++i) {
      const bool inside = i / size < chart && i % size < chart;
      picture.rgba.insert(picture.rgba.end(),
                          {std::uint8_t(inside ? 10 : 250), std::uint8_t(inside ? 240 : 0), 0, 255});
    }
    const double half = 0.5 / size, step = double(texels) / size;
    for (const std::size_t triangles : {2u, 1000u}) {
      int worst = 0;
      for (const auto& [p, v] :
           baked_sheet(picture, with(AlphaMode::opaque), {half, step, 0, half, 0, step}, cut_sheet(triangles, rng)))
        worst = std::max({worst, std::abs(int(v.rgba[0]) - 10), std::abs(int(v.rgba[1]) - 240)});
      RecordProperty("bleeds_" + std::to_string(texels) + "_" + std::to_string(triangles), worst);
      EXPECT_LE(worst, codes) << texels << " texels a voxel, " << triangles << " triangles, seed " << seed;
    }
  }
}

}  // namespace
}  // namespace gigabake::reference
