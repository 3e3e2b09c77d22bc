#include "viewer/live/live_scene.h"

#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mutex>
#include <unistd.h>
#include <vector>

#include "tests/format/shard/made_shard.h"
#include "tests/viewer/stored_hill.h"

namespace gigabake {
namespace {

constexpr double timeout_s = 60;  ///< much longer than any step of these tests

LiveScene::Options small_pictures() {
  LiveScene::Options options;
  options.renderer.threads = 1;
  options.camera.width = 96;
  options.camera.height = 64;
  options.max_viewers = 3;
  return options;
}

/// Returns options for images that take long to render, `frame_s` seconds per part.
LiveScene::Options large_pictures(int edge, double frame_s) {
  LiveScene::Options options = small_pictures();
  options.camera.width = options.camera.height = edge;
  options.frame_s = frame_s;
  return options;
}

ViewerInput turn(double right) {
  ViewerInput s;
  s.turn = {right, 0};
  return s;
}

Picture exact(const std::filesystem::path& scene, const View& view) {
  FrameRenderer::Options options;
  options.threads = 1;
  FrameRenderer renderer(scene, options);
  for (;;) {
    Frame frame = renderer.draw(view, 1);
    if (frame.stats.complete) return frame.picture;
  }
}

TEST(LiveScene, EndsWithTheExactPictureOfWhereEachViewerRests) {
  const made::TempFolder folder;
  write_hill(folder / "scene.xml");
  LiveScene scene(folder / "scene.xml", small_pictures());
  const auto first = scene.add_viewer().value(), second = scene.add_viewer().value();
  ASSERT_NE(scene.full_frame(first, timeout_s), nullptr);
  scene.steer(second, turn(0.3));
  for (const auto viewer : {first, second}) {
    const auto frame = scene.full_frame(viewer, timeout_s);
    ASSERT_NE(frame, nullptr);
    View view = frame->view;
    view.camera.eye_m = scene.state(viewer)->pose.eye_m;
    view.camera.target_m = scene.state(viewer)->pose.target_m;
    EXPECT_EQ(frame->frame.picture.width, 96);
    EXPECT_EQ(frame->frame.picture.rgba, exact(folder / "scene.xml", view).rgba);
  }
  EXPECT_NE(scene.full_frame(first, timeout_s)->frame.picture.rgba,
            scene.full_frame(second, timeout_s)->frame.picture.rgba);
}

/// Returns the first frame after `after` that satisfies `requested`, or null on a timeout.
template <class Wanted>
LiveScene::FramePtr wait_for(const LiveScene& scene, LiveScene::ViewerId viewer, std::uint64_t after,
                             const Wanted& requested) {
  for (;;) {
    const auto frame = scene.frame_after(viewer, after, timeout_s);
    if (!frame || requested(*frame)) return frame;
    after = frame->number;
  }
}

// 2026-11-22: a full frame was always rendered to its end, whatever the input during this time.
TEST(LiveScene, AFullPictureUnderWayEndsWhenItsViewerMoves) {
  const made::TempFolder folder;
  write_hill(folder / "scene.xml");
  LiveScene scene(folder / "scene.xml", large_pictures(2048, 0.02));
  const auto viewer = scene.add_viewer().value();
  const auto part =
      wait_for(scene, viewer, 0, [](const auto& frame) { return frame.full && !frame.frame.stats.complete; });
  ASSERT_NE(part, nullptr);
  EXPECT_LT(scene.state(viewer)->drawn, 1);
  scene.steer(viewer, turn(0.2));
  const Point<Scene> eye_m = scene.state(viewer)->pose.eye_m;
  const auto moved = wait_for(scene, viewer, part->number, [&](const auto& frame) {
    const bool is_there = frame.view.camera.eye_m == eye_m;
    EXPECT_FALSE(!is_there && frame.full && frame.frame.stats.complete) << "of a place that was left";
    return is_there;
  });
  ASSERT_NE(moved, nullptr);
  EXPECT_FALSE(scene.state(viewer)->resting);
}

TEST(LiveScene, ShowsASmallPictureOfAllBeforePartsOfTheFullOne) {
  const made::TempFolder folder;
  write_hill(folder / "scene.xml");
  LiveScene scene(folder / "scene.xml", large_pictures(512, 0.001));
  const auto viewer = scene.add_viewer().value();
  const auto first = scene.frame_after(viewer, 0, timeout_s);
  ASSERT_NE(first, nullptr);
  EXPECT_FALSE(first->full);
  EXPECT_LE(first->frame.picture.width, 512 / 4);
  const auto last = scene.full_frame(viewer, timeout_s);
  ASSERT_NE(last, nullptr);
  EXPECT_EQ(last->frame.picture.rgba, exact(folder / "scene.xml", last->view).rgba);
}

TEST(LiveScene, DrawsNothingWhileNobodyMoves) {
  const made::TempFolder folder;
  write_hill(folder / "scene.xml");
  LiveScene scene(folder / "scene.xml", small_pictures());
  const auto viewer = scene.add_viewer().value();
  const auto full = scene.full_frame(viewer, timeout_s);
  ASSERT_NE(full, nullptr);
  EXPECT_EQ(scene.frame_after(viewer, full->number, 0.7), nullptr);
  scene.steer(viewer, ViewerInput{});  // a mouse event without movement
  EXPECT_EQ(scene.frame_after(viewer, full->number, 0.3), nullptr);
  EXPECT_TRUE(scene.state(viewer)->resting);
  scene.steer(viewer, turn(0.01));
  EXPECT_NE(scene.frame_after(viewer, full->number, timeout_s), nullptr);
}

TEST(LiveScene, WaitsForASceneAndFollowsItsReplacement) {
  const made::TempFolder folder;
  LiveScene scene(folder / "scene.xml", small_pictures());
  const auto viewer = scene.add_viewer().value();
  EXPECT_EQ(scene.frame_after(viewer, 0, 0.2), nullptr);
  EXPECT_FALSE(scene.state(viewer)->has_scene);
  ViewerInput size;
  size.size = std::array<int, 2>{48, 40};
  scene.steer(viewer, size);

  write_hill(folder / "scene.xml", {200, 30, 30, 255});
  const auto red = scene.full_frame(viewer, timeout_s);
  ASSERT_NE(red, nullptr);
  EXPECT_EQ(red->frame.picture.width, 48);  // requested before there was a scene
  scene.steer(viewer, turn(0.2));
  const auto turned = scene.full_frame(viewer, timeout_s);
  const CameraPose pose = scene.state(viewer)->pose;

  write_hill(folder / "scene.xml", {30, 30, 200, 255});
  const auto blue = scene.frame_after(viewer, turned->number, timeout_s);
  ASSERT_NE(blue, nullptr);
  EXPECT_NE(scene.full_frame(viewer, timeout_s)->frame.picture.rgba, turned->frame.picture.rgba);
  EXPECT_EQ(scene.state(viewer)->pose, pose);
}

/// Returns the size of this process's address space, which contains the pools from their allocation on.
std::uint64_t address_space_bytes() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * std::uint64_t(::sysconf(_SC_PAGESIZE));
}

/// 2026-11-26: a viewer held the pools of the previous scene until the pools of the next scene were allocated.
/// `look` is called as soon as a scene has its renderer.
TEST(LiveScene, HoldsOneSetOfPoolsWhileItReloads) {
  const made::TempFolder folder;
  const std::uint64_t before = address_space_bytes();
  std::mutex mutex;
  std::vector<std::uint64_t> loaded;
  LiveScene::Options options = small_pictures();
  options.look = [&](const SceneHeader&) {
    const std::lock_guard lock(mutex);
    loaded.push_back(address_space_bytes());
    return ViewerInput{};
  };
  write_hill(folder / "scene.xml", {200, 30, 30, 255});
  {
    LiveScene scene(folder / "scene.xml", options);
    const auto viewer = scene.add_viewer().value();
    const auto red = scene.full_frame(viewer, timeout_s);
    ASSERT_NE(red, nullptr);
    write_hill(folder / "scene.xml", {30, 30, 200, 255});
    ASSERT_NE(scene.frame_after(viewer, red->number, timeout_s), nullptr);
  }
  ASSERT_EQ(loaded.size(), 2u);
  const std::uint64_t pools = loaded[0] - before;
  EXPECT_GT(pools, options.renderer.memory_bytes / 4) << "the pools count";
  EXPECT_LT(loaded[1], loaded[0] + pools / 2);
}

TEST(LiveScene, SaysWhatIsWrongWithASceneAndGoesOnWhenItIsRight) {
  const made::TempFolder folder;
  std::ofstream(folder / "scene.xml") << "<no";
  LiveScene scene(folder / "scene.xml", small_pictures());
  const auto viewer = scene.add_viewer().value();
  for (int i = 0; i < 600 && scene.state(viewer)->problem.empty(); ++i) scene.frame_after(viewer, 0, 0.1);
  EXPECT_THAT(scene.state(viewer)->problem, testing::HasSubstr("scene.xml"));
  write_hill(folder / "scene.xml");
  EXPECT_NE(scene.full_frame(viewer, timeout_s), nullptr);
  EXPECT_EQ(scene.state(viewer)->problem, "");
}

TEST(LiveScene, TakesNoMoreViewersThanAskedAndForgetsThoseThatLeave) {
  const made::TempFolder folder;
  write_hill(folder / "scene.xml");
  LiveScene scene(folder / "scene.xml", small_pictures());
  const auto gone = scene.add_viewer().value();
  scene.add_viewer();
  scene.add_viewer();
  EXPECT_FALSE(scene.add_viewer().has_value());
  scene.remove_viewer(gone);
  EXPECT_TRUE(scene.add_viewer().has_value());
  EXPECT_FALSE(scene.steer(gone, {}));
  EXPECT_FALSE(scene.state(gone).has_value());
  EXPECT_EQ(scene.frame_after(gone, 0, timeout_s), nullptr);
}

TEST(LiveScene, StoppingEndsEveryWait) {
  const made::TempFolder folder;
  LiveScene scene(folder / "scene.xml", small_pictures());
  const auto viewer = scene.add_viewer().value();
  std::thread stops([&] { scene.stop(); });
  EXPECT_EQ(scene.full_frame(viewer, 3600), nullptr);
  stops.join();
}

}  // namespace
}  // namespace gigabake
