#include "viewer/frame_renderer.h"

#include <gtest/gtest.h>

#include "format/error.h"
#include "ground_scene.h"

namespace gigabake {
namespace {

View looking(const std::array<double, 3>& eye_m, const std::array<double, 3>& target_m, int edge = 120) {
  return {view(eye_m, target_m, edge).camera, ViewMode::lit, {}};
}

FrameRenderer renderer_of(const VoxelScene& scene, std::uint64_t memory_bytes, const PageSource& pages = {}) {
  FrameRenderer::Options options;
  options.threads = 2;
  options.memory_bytes = memory_bytes;
  return FrameRenderer(scene.description(), "scene.xml", pages ? pages : scene.pages(), options);
}

Frame draw_until_complete(FrameRenderer& renderer, const View& view) {
  Frame frame;
  for (int i = 0; i < 100000 && !frame.stats.complete; ++i) frame = renderer.draw(view, 0.001);
  return frame;
}

TEST(FrameRenderer, ComesToTheExactPictureForAnyPool) {
  const VoxelScene scene = wide_ground(64);
  const View view = looking({-20, -30, 60}, {128, 128, 0});
  FrameRenderer exact = renderer_of(scene, std::uint64_t(1) << 28);
  const Picture expected = exact.draw_exact(view).picture;
  for (const std::uint64_t memory : {std::uint64_t(300000), std::uint64_t(3000000), std::uint64_t(1) << 28}) {
    FrameRenderer renderer = renderer_of(scene, memory);
    const Frame frame = draw_until_complete(renderer, view);
    EXPECT_TRUE(frame.stats.complete);
    EXPECT_EQ(frame.picture.rgba, expected.rgba) << memory << " bytes";
    EXPECT_EQ(frame.picture.depth, expected.depth) << memory << " bytes";
  }
}

TEST(FrameRenderer, ComesToTheSamePictureWhateverTheWayThere) {
  const VoxelScene scene = wide_ground(64);
  const View last = looking({200, 40, 50}, {128, 128, 0});
  FrameRenderer straight = renderer_of(scene, std::uint64_t(1) << 28), far = renderer_of(scene, 3000000);
  for (int i = 0; i < 40; ++i) far.draw(looking({i * 7.0, 300 - i * 9.0, 30.0 + i}, {100, 100, 0}), 0.0005);
  EXPECT_EQ(draw_until_complete(far, last).picture.rgba, draw_until_complete(straight, last).picture.rgba);
}

TEST(FrameRenderer, NeverHoldsMoreThanItMay) {
  const VoxelScene scene = wide_ground(64);
  FrameRenderer renderer = renderer_of(scene, 3000000);
  std::uint64_t uploads = 0;
  for (int i = 0; i < 120; ++i) {
    const Frame frame = renderer.draw(looking({i * 2.0, 300 - i * 3.0, 25.0 + i % 7}, {128, 128, 0}), 0.01);
    uploads += frame.stats.uploads;
    // What one pass looks at stays beyond the bound: eight bricks' pages a want, and those being read.
    EXPECT_LE(frame.stats.bytes_held, frame.stats.bytes_allowed + 2000000);
    EXPECT_LE(frame.stats.bytes_allowed, 3000000u);
  }
  EXPECT_GT(uploads, 500u);
}

TEST(FrameRenderer, ShowsCoarserBricksWhileFinerOnesAreMissing) {
  const VoxelScene scene = wide_ground(64);
  FrameRenderer renderer = renderer_of(scene, std::uint64_t(1) << 28);
  const View near = looking({128, 128, 60}, {128.1, 128, 12}, 40);
  View far = near;
  far.camera.pixel_error = 8;
  draw_until_complete(renderer, far);
  const Frame first = renderer.draw(near, 0);
  EXPECT_FALSE(first.stats.complete);
  std::size_t opaque = 0;
  for (std::size_t i = 0; i < first.picture.depth.size(); ++i)
    opaque += first.picture.depth[i] < kernels::CastRay::no_depth ? 1 : 0;
  EXPECT_EQ(opaque, first.picture.depth.size());
}

TEST(FrameRenderer, DrawsWhatIsDamagedAsItsParentAndSaysSo) {
  const VoxelScene scene = wide_ground(64);
  const View view = looking({128, 128, 200}, {128.1, 128, 0});
  const PageSource inner = scene.pages();
  const PageSource damaged = [inner](const PageKey& key) {
    if (key.cell == 5 && key.lod == 0) throw InputError("shards/c_6.h5", "lod_0/rgba", "bad checksum; bake it again");
    return inner(key);
  };
  const PageSource without_lod_0 = [inner](const PageKey& key) {
    if (key.cell == 5 && key.lod < 0) throw InputError("shards/c_6.h5", "", "no such file");
    return inner(key);
  };
  FrameRenderer whole = renderer_of(scene, std::uint64_t(1) << 28);
  const Frame expected = whole.draw_exact(view);
  for (const bool all : {false, true}) {
    FrameRenderer renderer = renderer_of(scene, std::uint64_t(1) << 28, all ? without_lod_0 : damaged);
    const Frame frame = draw_until_complete(renderer, view);
    ASSERT_TRUE(frame.stats.complete);
    ASSERT_EQ(renderer.problems().size(), 1u);
    EXPECT_NE(renderer.problems()[0].find("c_6.h5"), std::string::npos);
    EXPECT_EQ(renderer.draw_exact(view).picture.rgba, frame.picture.rgba);
    std::size_t different = 0;
    for (std::size_t i = 0; i < frame.picture.depth.size(); ++i)
      different += frame.picture.depth[i] != expected.picture.depth[i] ? 1 : 0;
    EXPECT_GT(different, 0u);
    EXPECT_LT(different, frame.picture.depth.size() / 3) << "the cell is a fifth of the picture";
  }
}

TEST(FrameRenderer, HasAPictureForEveryMode) {
  const VoxelScene scene = wide_ground(64);
  FrameRenderer renderer = renderer_of(scene, std::uint64_t(1) << 28);
  View view = looking({-20, -30, 60}, {128, 128, 0}, 64);
  std::vector<std::vector<std::uint8_t>> pictures;
  for (std::size_t m = 0; m < view_mode_names().size(); ++m) {
    view.mode = ViewMode(m);
    const Frame frame = draw_until_complete(renderer, view);
    EXPECT_TRUE(frame.stats.complete);
    for (const auto& other : pictures) EXPECT_NE(frame.picture.rgba, other) << view_mode_names()[m];
    pictures.push_back(frame.picture.rgba);
  }
}

}  // namespace
}  // namespace gigabake
