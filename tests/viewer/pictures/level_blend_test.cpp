// Blending between levels: weight and level of the second ray, and its effect in images.
#include "kernels/marching/level_blend.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "tests/random_seed.h"
#include "tests/viewer/ground_scene.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake {
namespace {

kernels::CastScene of_lods(int lods) {
  kernels::CastScene scene;
  scene.lods = lods;
  return scene;
}

TEST(LevelBlend, SharesRiseFromNothingToAllBeforeALevelEnds) {
  const test::RandomSeed seed;
  std::mt19937_64 random(seed);
  const kernels::CastScene scene = of_lods(8);
  for (int i = 0; i < 2000; ++i) {
    kernels::CastLine line;
    line.lod1_distance = std::exp2(std::uniform_real_distribution<>(6, 14)(random));
    const int lod = int(random() % 7);
    const double end = kernels::lod_end(line, lod);
    EXPECT_EQ(kernels::coarser_share(scene, line, end * kernels::blend_from), 0);
    EXPECT_NEAR(kernels::coarser_share(scene, line, end * (1 - 1e-9)), 1, 1e-6);
    EXPECT_EQ(kernels::coarser_share(scene, line, end), 0);
    EXPECT_EQ(kernels::coarser_share(of_lods(lod + 1), line, end * 0.99), 0) << "nothing is coarser";
  }
}

TEST(LevelBlend, TheSecondRayIsOneLevelCoarserWhereverItHasAShare) {
  const test::RandomSeed seed;
  std::mt19937_64 random(seed);
  for (int i = 0; i < 2000; ++i) {
    kernels::CastLine line, coarser;
    line.lod1_distance = std::exp2(std::uniform_real_distribution<>(7, 14)(random));
    coarser.lod1_distance = line.lod1_distance * kernels::coarser_from;
    const int lod = int(random() % 7);
    const double end = kernels::lod_end(line, lod);
    EXPECT_LE(kernels::lod_end(coarser, lod), end * kernels::blend_from) << line.lod1_distance;
    EXPECT_GE(kernels::lod_start(coarser, lod + 2), end) << line.lod1_distance;
  }
}

View ground_view(double distance, double middle, LevelBlend blend) {
  View out{
      view({middle, middle - distance * 0.8, 13 + distance * 0.6}, {middle, middle, 13}, 96).camera, ViewMode::lod, {}};
  out.level_blend = blend;
  return out;
}

/// Returns the max. difference of a channel between two images, in the middle of the image.
int max_change(const Picture& a, const Picture& b) {
  int maximum = 0;
  for (std::size_t y = 40; y < 56; ++y)
    for (std::size_t x = 40; x < 56; ++x)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = 4 * (y * 96 + x) + k;
        maximum = std::max(maximum, std::abs(int(a.rgba[i]) - int(b.rgba[i])));
      }
  return maximum;
}

/// Returns ground of 256 × 256 voxels.
VoxelScene flat_ground() {
  VoxelScene scene(64);
  for (std::int64_t y = 0; y < 4; ++y)
    for (std::int64_t x = 0; x < 4; ++x)
      scene.add_cell(
          [](std::int64_t, std::int64_t, std::int64_t z) -> std::optional<Paint> {
            if (z > 12) return {};
            return Paint{{200, 200, 200, 255}, {}};
          },
          {x * 64, y * 64, 0});
  return scene;
}

/// Levels have debug colours. Without blending a pixel jumps from one colour to the next; with blending changes are
/// small.
TEST(LevelBlend, NoPixelJumpsFromLevelToLevelAsTheEyeMoves) {
  const VoxelScene scene = flat_ground();
  FrameRenderer::Options options;
  options.threads = 2;
  FrameRenderer renderer(scene.description(), "scene.xml", scene.pages(), options);
  const double lod1 = 96 / std::tan(20 * 3.14159265358979 / 180);
  int maximum[2] = {0, 0};
  for (const LevelBlend blend : {LevelBlend::off, LevelBlend::on}) {
    Picture last;
    for (double distance = 0.9 * lod1; distance < 2.3 * lod1; distance *= 1.02) {
      Picture now = renderer.render_complete(ground_view(distance, 128, blend)).picture;
      if (last.width > 0) maximum[int(blend)] = std::max(maximum[int(blend)], max_change(last, now));
      last = std::move(now);
    }
  }
  EXPECT_GT(maximum[0], 90);
  EXPECT_LT(maximum[1], 60);
}

TEST(LevelBlend, IsTheSameBytesInTilesAsAWholeAndWithAnyMemory) {
  const VoxelScene scene = wide_ground();
  FrameRenderer::Options options;
  options.threads = 2;
  FrameRenderer renderer(scene.description(), "scene.xml", scene.pages(), options);
  View view_of = ground_view(400, 64, LevelBlend::on);
  for (const ViewMode mode : {ViewMode::lit, ViewMode::shadow}) {
    view_of.mode = mode;
    const Picture tiles = renderer.render_complete(view_of).picture;
    Frame whole;
    for (int i = 0; i < 1000 && !whole.stats.complete; ++i) whole = renderer.draw(view_of, 1);
    EXPECT_EQ(whole.picture.rgba, tiles.rgba);
    EXPECT_EQ(whole.picture.depth, tiles.depth);
    FrameRenderer::Options little = options;
    little.threads = 1;
    little.memory_bytes = std::uint64_t(3) << 20;
    FrameRenderer small(scene.description(), "scene.xml", scene.pages(), little);
    EXPECT_EQ(small.render_complete(view_of).picture.rgba, tiles.rgba);
    view_of.level_blend = LevelBlend::off;
    EXPECT_NE(renderer.render_complete(view_of).picture.rgba, tiles.rgba) << "there is something to blend";
    view_of.level_blend = LevelBlend::on;
  }
}

}  // namespace
}  // namespace gigabake
