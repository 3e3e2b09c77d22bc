// Passes of rays over tiles, and waits for pages between them. Images that are complete at once use large tiles.
#include <algorithm>
#include <gtest/gtest.h>
#include <random>

#include "tests/viewer/ground_scene.h"
#include "viewer/pictures/frame_renderer.h"
#include "viewer/pictures/render.h"

namespace gigabake {
namespace {

constexpr std::uint64_t enough = std::uint64_t(1) << 30;

FrameRenderer renderer_of(const VoxelScene& scene, std::uint64_t memory_bytes, int threads) {
  FrameRenderer::Options options;
  options.threads = threads;
  options.memory_bytes = memory_bytes;
  return FrameRenderer(scene.description(), "scene.xml", scene.pages(), options);
}

/// Returns a view with shadows and blended levels, so that each tile has four phases of rays.
View view_of_all(int width, int height) {
  View out{view({-20, -30, 60}, {128, 128, 0}).camera, ViewMode::lit, {}, PictureLight::linear_too};
  out.camera.width = width;
  out.camera.height = height;
  out.shadows = Shadows::on;
  out.level_blend = LevelBlend::on;
  return out;
}

/// Returns the image that the viewer completes tile by tile.
Frame render_watched(FrameRenderer& renderer, const View& view) {
  ProgressiveFrame frame = renderer.begin(view, nullptr);
  while (!frame.is_complete()) renderer.resume(frame, [] { return true; }, {});
  return {std::move(frame.picture), frame.stats};
}

// 2026-11-28: all threads waited for the pages of each small tile. This image needed 457 passes and waited 25 times.
TEST(RenderPasses, LargeTilesNeedFewPassesAndHardlyWaitForPages) {
  const VoxelScene scene = wide_ground(64);
  const View view = view_of_all(1280, 720);
  FrameRenderer small = renderer_of(scene, enough, 8), large = renderer_of(scene, enough, 8);
  const Frame watched = render_watched(small, view), whole = large.render_complete(view);
  EXPECT_EQ(whole.picture.rgba, watched.picture.rgba);
  EXPECT_EQ(whole.picture.linear, watched.picture.linear);
  EXPECT_LE(whole.stats.passes, 160u) << "watched: " << watched.stats.passes;
  EXPECT_LE(whole.stats.page_waits, 6u) << "watched: " << watched.stats.page_waits;
}

TEST(RenderPasses, ImagesAreTheSameBytesForAnyThreadsAndMemory) {
  const VoxelScene scene = wide_ground(64);
  const View view = view_of_all(400, 300);
  FrameRenderer first = renderer_of(scene, enough, 1);
  const Picture expected = render_watched(first, view).picture;
  for (const int threads : {1, 2, 7})
    for (const std::uint64_t memory :
         {std::uint64_t(3) << 20, std::uint64_t(12) << 20, std::uint64_t(256) << 20, enough}) {
      FrameRenderer renderer = renderer_of(scene, memory, threads);
      const Frame frame = renderer.render_complete(view);
      EXPECT_EQ(frame.picture.rgba, expected.rgba) << threads << " " << memory;
      EXPECT_EQ(frame.picture.linear, expected.linear) << threads << " " << memory;
      EXPECT_EQ(frame.picture.depth, expected.depth) << threads << " " << memory;
    }
}

/// Expects tiles that cover each pixel of the image once, within the bounds of large_tiles_of().
void expect_cover(const std::vector<kernels::CastTile>& tiles, int width, int height, int unit, std::uint64_t pixels) {
  std::vector<int> covered(std::size_t(width) * std::size_t(height));
  for (const kernels::CastTile& tile : tiles) {
    EXPECT_EQ(tile.x % unit, 0);
    EXPECT_EQ(tile.y % unit, 0);
    EXPECT_LE(std::uint64_t(tile.width) * std::uint64_t(tile.height), std::max<std::uint64_t>(pixels, unit * unit));
    for (int y = tile.y; y < tile.y + tile.height; ++y)
      for (int x = tile.x; x < tile.x + tile.width; ++x) ++covered[std::size_t(y * width + x)];
  }
  EXPECT_EQ(std::count(covered.begin(), covered.end(), 1), std::int64_t(width) * height);
}

TEST(RenderPasses, LargeTilesCoverAnImageOnceAndNoOtherSizeNeedsLess) {
  constexpr int unit = 8;
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const int width = 1 + int(random() % 300), height = 1 + int(random() % 200);
    const std::uint64_t pixels = random() % 20000;
    const std::vector<kernels::CastTile> tiles = large_tiles_of(width, height, unit, pixels);
    expect_cover(tiles, width, height, unit, pixels);
    std::size_t min_tiles = SIZE_MAX;
    for (int w = unit; w < width + unit; w += unit)
      for (int h = unit; h < height + unit; h += unit)
        if (std::uint64_t(w) * std::uint64_t(h) <= std::max<std::uint64_t>(pixels, unit * unit))
          min_tiles = std::min(min_tiles, std::size_t((width + w - 1) / w) * std::size_t((height + h - 1) / h));
    EXPECT_EQ(tiles.size(), min_tiles);
  }
  EXPECT_EQ(large_tiles_of(1920, 1080, 128, 174000).size(), 15u);
}

}  // namespace
}  // namespace gigabake
