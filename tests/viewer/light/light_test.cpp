#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "core/math/octahedral.h"
#include "tests/viewer/ground_scene.h"
#include "tests/viewer/voxel_scene.h"
#include "viewer/light/sky.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake {
namespace {

FrameRenderer lit_renderer(const VoxelScene& scene, FrameRenderer::Options options = {}) {
  options.threads = 2;
  return FrameRenderer(scene.description(), "scene.xml", scene.pages(), options);
}

View lit_view(const std::array<double, 3>& eye_m, const std::array<double, 3>& target_m, int edge) {
  return {view(eye_m, target_m, edge).camera, ViewMode::lit, {}, PictureLight::linear_too};
}

/// Returns white houses, 12 m wide and 10 m high, on white ground.
VoxelScene white_town() {
  VoxelScene scene(64);
  scene.add_cells(
      [](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
        const std::int64_t u = x % 21, v = y % 21;
        const bool house = u >= 4 && u < 16 && v >= 4 && v < 16;
        if (z != 0 && !(house && z <= 10)) return {};
        double normal[3] = {0, 0, 1};
        if (house && z > 0 && z < 10) {
          normal[0] = u == 4 ? -1 : (u == 15 ? 1 : 0);
          normal[1] = v == 4 ? -1 : (v == 15 ? 1 : 0);
          normal[2] = 0;
        }
        Paint paint;
        encode_octahedral(normal[0], normal[1], normal[2], paint.normal.data());
        return paint;
      },
      {0, 0, 0}, 64);
  return scene;
}

/// Returns the sRGB code of linear light by IEC 61966-2-1, 0 to 255, not rounded.
double srgb_code(double linear) {
  return 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
}

// 2026-11-22: 58 % of the channels of a city's pixels were clipped to 255.
TEST(Light, ShowsAWhiteTownWithoutClippingAndItsWallsApart) {
  const VoxelScene town = white_town();
  FrameRenderer renderer = lit_renderer(town);
  for (const std::array<double, 3>& eye : {std::array{-60.0, -70.0, 60.0}, std::array{120.0, 130.0, 40.0}}) {
    const Picture picture = renderer.render_complete(lit_view(eye, {32, 32, 0}, 160)).picture;
    const auto clipped = std::count(picture.rgba.begin(), picture.rgba.end(), 255) - 160 * 160;  // alpha
    EXPECT_LT(double(clipped), 0.01 * 3 * 160 * 160);
  }
  const auto shown = [](double light) { return kernels::shown_light(screen_tone(0), float(light)); };
  EXPECT_GT(srgb_code(shown(1.33)) - srgb_code(shown(1.02)), 5);  // a wall that faces the sun, and the ground
}

TEST(Light, IsShownAsItIsUpToTheKneeAndRisesBelowOneBeyond) {
  const kernels::CastTone tone = screen_tone(0);
  float before = -1;
  for (int i = 0; i <= 40000; ++i) {
    const float light = float(i) * 1e-4f, shown = kernels::shown_light(tone, light);
    ASSERT_GT(shown, before) << light;
    ASSERT_LT(shown, 1) << light;
    ASSERT_LE(shown - before, 1.01e-4f + (i == 0 ? 1 : 0)) << light;  // continuous
    ASSERT_TRUE(light > tone.knee || shown == light) << light;
    before = shown;
  }
  EXPECT_EQ(kernels::shown_light(screen_tone(1), 0.2f), 0.4f);
  EXPECT_EQ(kernels::shown_light({}, 7.5f), 7.5f);
}

TEST(Light, IsNotBentWhereColoursAreAskedForOrBehindTheScene) {
  const VoxelScene town = white_town();
  FrameRenderer renderer = lit_renderer(town);
  View view = lit_view({32, 32, 90}, {32, 32.1, 0}, 32);
  view.mode = ViewMode::albedo;
  view.background = {false, {255, 255, 255, 255}};
  EXPECT_EQ(renderer.render_complete(view).picture.rgba, std::vector<std::uint8_t>(4 * 32 * 32, 255));
  view = lit_view({32, 32, 90}, {32, 32.1, 900}, 8);
  view.background = {false, {255, 254, 253, 255}};
  const Picture away = renderer.render_complete(view).picture;
  for (std::size_t i = 0; i < away.rgba.size(); ++i) EXPECT_EQ(away.rgba[i], (std::array{255, 254, 253, 255})[i % 4]);
}

// 2026-11-22: a sky had bands of ten equal rows.
TEST(Light, ASkyHasNoBandsAndTheRightMean) {
  const VoxelScene town = white_town();
  FrameRenderer renderer = lit_renderer(town);
  View view = lit_view({32, 32, 90}, {32, 300, 160}, 400);
  const Picture sky = renderer.render_complete(view).picture;
  int equal_rows = 0, max_equal_rows = 0;
  for (std::ptrdiff_t y = 1; y < 400; ++y) {
    const auto row = sky.rgba.begin() + 1600 * y;
    equal_rows = std::equal(row, row + 1600, row - 1600) ? equal_rows + 1 : 0;
    max_equal_rows = std::max(max_equal_rows, equal_rows);
  }
  EXPECT_LE(max_equal_rows, 1);
  double worst = 0;
  for (std::size_t top = 0; top < 400; top += 8)
    for (std::size_t k = 0; k < 3; ++k) {
      double shown = 0, exact = 0;
      for (std::size_t i = 0; i < 8 * 400; ++i) {
        const std::size_t at = 4 * (top * 400 + i) + k;
        shown += sky.rgba[at] / 3200.0;
        exact += srgb_code(kernels::shown_light(screen_tone(0), sky.linear[at])) / 3200;
      }
      worst = std::max(worst, std::fabs(shown - exact));
    }
  EXPECT_LT(worst, 0.1);
}

TEST(Light, PicturesAreTheSameWhetherDrawnAsAWholeOrInTiles) {
  const VoxelScene town = white_town();
  FrameRenderer::Options options;
  options.haze_visibility_m = 200;
  FrameRenderer renderer = lit_renderer(town, options);
  const View view = lit_view({-60, -70, 60}, {32, 32, 20}, 300);
  const Picture tiles = renderer.render_complete(view).picture;
  Frame whole;
  for (int i = 0; i < 1000 && !whole.stats.complete; ++i) whole = renderer.draw(view, 1);
  EXPECT_EQ(whole.picture.rgba, tiles.rgba);
}

// 2026-11-22: the air absorbed a tenth of the light across the scene, and could not be disabled.
TEST(Haze, IsOffUnlessAskedForAndLeavesATwentiethAtItsDistance) {
  EXPECT_EQ(air(HUGE_VAL, 0.25).per_voxel, 0);
  const kernels::CastHaze haze = air(150, 0.25);
  EXPECT_NEAR(kernels::exp_minus(float(150 / 0.25) * haze.per_voxel), 0.05, 1e-4);

  const VoxelScene town = white_town();
  const View sky = lit_view({-60, -70, 60}, {32, 32, 0}, 64);
  View none = sky;
  none.background = {false, {0, 0, 0, 0}};
  FrameRenderer clear = lit_renderer(town);
  FrameRenderer::Options options;
  options.haze_visibility_m = 150;
  FrameRenderer hazy = lit_renderer(town, options);
  const Picture before_sky = clear.render_complete(sky).picture, alone = clear.render_complete(none).picture,
                in_haze = hazy.render_complete(sky).picture;
  int compared = 0;
  for (std::size_t i = 0; i < 64 * 64; ++i) {
    if (alone.linear[4 * i + 3] != 1) continue;
    const double seen = std::pow(0.05, alone.depth[i] / 150);
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(before_sky.linear[4 * i + k], alone.linear[4 * i + k]);
      ASSERT_EQ(before_sky.rgba[4 * i + k], alone.rgba[4 * i + k]);
      ASSERT_NEAR(in_haze.linear[4 * i + k], alone.linear[4 * i + k] * seen + haze.rgb[k] * (1 - seen), 0.02);
    }
    ++compared;
  }
  EXPECT_GT(compared, 500);
  EXPECT_EQ(hazy.render_complete(none).picture.linear, alone.linear);
}

}  // namespace
}  // namespace gigabake
