#include "viewer/pictures/frame_renderer.h"

#include <algorithm>
#include <atomic>
#include <gtest/gtest.h>
#include <random>

#include "core/base/error.h"
#include "kernels/cuda/baker.h"
#include "tests/viewer/ground_scene.h"
#include "viewer/pictures/render.h"

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

void fly_by(FrameRenderer& renderer) {
  for (int i = 0; i < 40; ++i) renderer.draw(looking({i * 7.0, 300 - i * 9.0, 30.0 + i}, {100, 100, 0}), 0.0005);
}

TEST(FrameRenderer, ComesToTheExactPictureForAnyPool) {
  const VoxelScene scene = wide_ground(64);
  const View view = looking({-20, -30, 60}, {128, 128, 0});
  FrameRenderer exact = renderer_of(scene, std::uint64_t(1) << 28);
  const Picture expected = exact.render_complete(view).picture;
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
  fly_by(far);
  EXPECT_EQ(draw_until_complete(far, last).picture.rgba, draw_until_complete(straight, last).picture.rgba);
}

// 2026-11-29: rays of a flight were cast twice per frame, first to wait for uploads for which there was no time.
TEST(FrameRenderer, AFrameWithoutTimeForUploadsCastsItsRaysOnce) {
  const VoxelScene scene = wide_ground(64);
  const View view = looking({-20, -30, 60}, {128, 128, 0}, 60);
  const Picture expected = renderer_of(scene, std::uint64_t(1) << 28).render_complete(view).picture;
  FrameRenderer renderer = renderer_of(scene, std::uint64_t(1) << 28);
  Frame frame;
  for (int i = 0; i < 100000 && !frame.stats.complete; ++i) {
    frame = renderer.draw(view, 0);
    ASSERT_EQ(frame.stats.passes, 1u) << "frame " << i;
  }
  EXPECT_TRUE(frame.stats.complete);
  EXPECT_EQ(frame.picture.rgba, expected.rgba);
  EXPECT_EQ(frame.picture.depth, expected.depth);
}

TEST(FrameRenderer, OnADeviceComesToTheSamePictureWhateverTheWayThere) {
  const kernels::CudaDevices devices = kernels::cuda_devices();
  if (devices.usable.empty()) GTEST_SKIP() << "no GPU: " << devices.reason;
  const VoxelScene scene = wide_ground(64);
  const View last = looking({200, 40, 50}, {128, 128, 0});
  const Picture expected = renderer_of(scene, std::uint64_t(1) << 28).render_complete(last).picture;
  for (const std::uint64_t pool : {std::uint64_t(1) << 19, std::uint64_t(1) << 21, std::uint64_t(1) << 26}) {
    FrameRenderer::Options options;
    options.threads = 2;
    options.memory_bytes = std::uint64_t(1) << 26;
    options.cuda_device = devices.usable[0];
    options.device_bytes = pool;
    FrameRenderer far(scene.description(), "scene.xml", scene.pages(), options);
    fly_by(far);
    const Frame frame = draw_until_complete(far, last);
    EXPECT_TRUE(frame.stats.complete);
    EXPECT_EQ(frame.picture.rgba, expected.rgba) << pool << " bytes of pools";
    EXPECT_EQ(frame.picture.depth, expected.depth) << pool << " bytes of pools";
  }
}

TEST(FrameRenderer, NeverHoldsMoreThanItMay) {
  const VoxelScene scene = wide_ground(64);
  FrameRenderer renderer = renderer_of(scene, 3000000);
  std::uint64_t uploads = 0;
  for (int i = 0; i < 120; ++i) {
    const Frame frame = renderer.draw(looking({i * 2.0, 300 - i * 3.0, 25.0 + i % 7}, {128, 128, 0}), 0.01);
    uploads += frame.stats.uploads;
    // One pass may exceed the limit by the pages of eight bricks per request and by the pages that are being read.
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

// 2026-11-22: a full frame could not be cancelled, and a window froze for seconds.
TEST(FrameRenderer, AFrameInTilesEndsWithinAStepWhenAskedAndComesToTheSameBits) {
  const VoxelScene scene = wide_ground(64);
  const View view = looking({-20, -30, 60}, {128, 128, 0}, 260), other = looking({200, 40, 50}, {128, 128, 0}, 90);
  const Picture expected = renderer_of(scene, std::uint64_t(1) << 28).render_complete(view).picture;
  for (const std::uint64_t memory : {std::uint64_t(3000000), std::uint64_t(1) << 28}) {
    FrameRenderer renderer = renderer_of(scene, memory);
    ProgressiveFrame frame = renderer.begin(view, nullptr);
    ASSERT_GT(frame.tiles.size(), 4u);
    std::mt19937 random(17);
    int stops = 0;
    for (int turn = 0; !frame.is_complete(); ++turn) {
      const std::size_t before = frame.done;
      std::atomic<int> asked{0}, after_stop{0};
      const int allowed = int(random() % 60) + 4 * turn;
      const auto stop = [&] {
        after_stop += asked > allowed ? 1 : 0;
        return asked++ >= allowed;
      };
      renderer.resume(
          frame, [] { return true; }, stop);
      EXPECT_LE(frame.done, before + 1);
      EXPECT_LE(after_stop, 8) << "it continued after a stop was requested";
      stops += frame.done == before ? 1 : 0;
      if (turn % 5 == 0) renderer.render_preview(other, {0.001, 0, {}});
      ASSERT_LT(turn, 3000);
    }
    EXPECT_GT(stops, 3) << memory;
    EXPECT_EQ(frame.picture.rgba, expected.rgba) << memory << " bytes, seed 17";
    EXPECT_EQ(frame.picture.depth, expected.depth) << memory << " bytes, seed 17";
    EXPECT_TRUE(frame.stats.complete);
  }
}

TEST(FrameRenderer, AStoppedPassOfRaysGoesOnWithTheSameBits) {
  const VoxelScene scene = wide_ground(64);
  const ThreadPool policy(2);
  const View view = looking({-20, -30, 60}, {128, 128, 0}, 160);
  SceneStream stream(scene.paged(), scene.pages(), {}, policy);
  const kernels::CastCamera camera = make_camera(view.camera, scene.paged());
  const Picture expected = render(stream, camera, {});  // everything is resident now
  kernels::Caster& caster = stream.caster();
  caster.start(camera, {0, 0, 160, 160});
  int passes = 0;
  for (std::size_t waiting = 1; waiting > 0; ++passes) {
    std::atomic<int> asked{0};
    waiting = caster.cast(0, 160 * 160, true, [&] { return asked++ >= 3 + passes; });
    ASSERT_LT(passes, 1000);
  }
  EXPECT_GT(passes, 3);
  Picture picture = blank_picture(160, 160, PictureLight::srgb);
  caster.resolve(to_cast({}), pixels_of(picture));
  EXPECT_EQ(picture.rgba, expected.rgba);
}

// 2026-11-22: first frames showed only sky, because only data that rays had reached was requested.
TEST(FrameRenderer, AFirstSketchHasASurfaceWhereverTheFinalPictureHas) {
  const VoxelScene scene = wide_ground(64);
  for (const auto& eye_m :
       {std::array{-20.0, -30.0, 60.0}, std::array{128.0, 128.0, 30.0}, std::array{5.0, 5.0, 16.0}}) {
    View view = looking(eye_m, {140, 150, 10}, 90);
    view.background = {false, {0, 0, 0, 0}};
    const Picture last = renderer_of(scene, std::uint64_t(1) << 28).render_complete(view).picture;
    FrameRenderer renderer = renderer_of(scene, std::uint64_t(1) << 28);
    for (int frames = 0;; ++frames) {
      const Frame frame = renderer.render_preview(view, {0.0001, 60, {}});
      int minimum = 0;
      for (std::size_t i = 3; i < last.rgba.size(); i += 4)
        minimum = std::min(minimum, int(frame.picture.rgba[i]) - int(last.rgba[i]));
      EXPECT_GE(minimum, -13) << "frame " << frames << " from " << eye_m[0]
                              << ": a twentieth of the light comes through";
      if (frame.stats.complete) break;
    }
  }
}

TEST(FrameRenderer, DrawsWhatIsDamagedAsItsParentAndSaysSo) {
  const VoxelScene scene = wide_ground(64);
  const View view = looking({128, 128, 200}, {128.1, 128, 0});
  const PageSource inner = scene.pages();
  const PageSource damaged = [inner](const PageKey& key) {
    if (key.shard == 5 && key.part == 0) throw InputError("shards/c_6.h5", "lod_0/rgba", "bad checksum; bake it again");
    return inner(key);
  };
  const PageSource without_lod_0 = [inner](const PageKey& key) {
    if (key.shard == 5 && key.part < 0) throw InputError("shards/c_6.h5", "", "no such file");
    return inner(key);
  };
  FrameRenderer whole = renderer_of(scene, std::uint64_t(1) << 28);
  const Frame expected = whole.render_complete(view);
  for (const bool all : {false, true}) {
    FrameRenderer renderer = renderer_of(scene, std::uint64_t(1) << 28, all ? without_lod_0 : damaged);
    const Frame frame = draw_until_complete(renderer, view);
    ASSERT_TRUE(frame.stats.complete);
    ASSERT_EQ(renderer.problems().size(), 1u);
    EXPECT_NE(renderer.problems()[0].find("c_6.h5"), std::string::npos);
    EXPECT_EQ(renderer.render_complete(view).picture.rgba, frame.picture.rgba);
    std::size_t different = 0;
    for (std::size_t i = 0; i < frame.picture.depth.size(); ++i)
      different += frame.picture.depth[i] != expected.picture.depth[i] ? 1 : 0;
    EXPECT_GT(different, 0u);
    EXPECT_LT(different, frame.picture.depth.size() / 3) << "the cell covers a fifth of the image";
  }
}

TEST(FrameRenderer, HasAPictureForEveryMode) {
  const VoxelScene scene = wide_ground(64);
  FrameRenderer renderer = renderer_of(scene, std::uint64_t(1) << 28);
  View view = looking({-20, -30, 60}, {128, 128, 0}, 64);
  std::vector<std::vector<std::uint8_t>> pictures;
  for (const ViewMode mode : values_of<ViewMode>()) {
    view.mode = mode;
    if (mode == ViewMode::voxel_class) {
      EXPECT_THROW(renderer.render_complete(view), UsageError) << "the scene has no classes";
      continue;
    }
    const Frame frame = draw_until_complete(renderer, view);
    EXPECT_TRUE(frame.stats.complete);
    for (const auto& other : pictures) EXPECT_NE(frame.picture.rgba, other) << name_of(mode);
    pictures.push_back(frame.picture.rgba);
  }
}

}  // namespace
}  // namespace gigabake
