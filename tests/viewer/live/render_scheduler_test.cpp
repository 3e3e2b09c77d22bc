#include "viewer/live/render_scheduler.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace gigabake {
namespace {

CameraOptions home() {
  CameraOptions camera;
  camera.eye_m = Point<Scene>{0, -100, 50};
  camera.target_m = Point<Scene>{0, 0, 0};
  return camera;
}

FrameStats took(double seconds, bool complete) {
  FrameStats stats;
  stats.total_s = seconds;
  stats.complete = complete;
  return stats;
}

ViewerInput turning(double right) {
  ViewerInput s;
  s.turn = {right, 0};
  return s;
}

ViewerInput walk(double forward) {
  ViewerInput s;
  s.walk = std::array<double, 3>{forward, 0, 0};
  return s;
}

/// Executes requests in virtual time from `now_s` on, until there are none or until `until_s`. Returns the requests.
std::vector<RenderScheduler::RenderRequest> fly(RenderScheduler& scheduler, double& now_s, double until_s,
                                                double full_frame_s) {
  std::vector<RenderScheduler::RenderRequest> orders;
  while (now_s < until_s) {
    const auto order = scheduler.next(now_s);
    if (!order) {
      if (!(scheduler.next_call_s() < until_s)) break;
      now_s = std::max(now_s + 1e-6, scheduler.next_call_s());
      continue;
    }
    const double seconds = full_frame_s * order->share * order->share;
    now_s += seconds;
    scheduler.drawn(*order, took(seconds, true));
    orders.push_back(*order);
  }
  return orders;
}

// 2026-11-25: a window that is higher than wide cut off the scene in the home view.
TEST(RenderScheduler, IsAsFarFromTheSceneAtHomeAsANarrowWindowNeeds) {
  CameraOptions framed = home();
  framed.is_framed = true;
  RenderScheduler scheduler(framed, 0.05);
  double now_s = 0;
  const auto eye = [&] { return scheduler.next(now_s += 1).value().view.camera.eye_m.value(); };
  EXPECT_DOUBLE_EQ(eye().y, -100);
  ViewerInput narrow;
  narrow.size = {720, 1280};
  scheduler.steer(narrow, now_s);
  const double farther = (1280.0 / 720) / (720.0 / 1280);
  const auto far = eye();
  EXPECT_NEAR(far.y, -100 * farther, 1e-6);
  EXPECT_NEAR(far.z, 50 * farther, 1e-6);
  scheduler.steer(turning(0.1), now_s);
  const auto turned = eye();
  narrow.size = {600, 1280};
  scheduler.steer(narrow, now_s);
  EXPECT_NEAR(eye().x, turned.x, 1e-6) << "the viewer has moved";
  ViewerInput go_home;
  go_home.home = true;
  scheduler.steer(go_home, now_s);
  EXPECT_NEAR(eye().y, -100 * (1280.0 / 720) / (600.0 / 1280), 1e-6);
  narrow.size = {2000, 500};
  scheduler.steer(narrow, now_s);
  EXPECT_NEAR(eye().y, -100, 1e-6);
}

// 2026-11-25: a window of another aspect ratio than the home image moved the eye that `--eye` specifies.
TEST(RenderScheduler, KeepsAnEyeThatTheUserGaveInAWindowOfAnyShape) {
  RenderScheduler scheduler(home(), 0.05);
  ViewerInput narrow;
  narrow.size = {320, 1280};
  narrow.home = true;
  scheduler.steer(narrow, 1);
  EXPECT_DOUBLE_EQ(scheduler.next(2).value().view.camera.eye_m.value().y, -100);
}

TEST(RenderScheduler, DrawsTheFullPictureOnceAndThenNothingMore) {
  RenderScheduler scheduler(home(), 0.05);
  double now_s = 0;
  const auto orders = fly(scheduler, now_s, 10, 0.5);
  ASSERT_FALSE(orders.empty());
  for (const auto& order : orders) EXPECT_EQ(order.full, &order == &orders.back());
  EXPECT_EQ(orders.back().view.camera.width, 1280);
  EXPECT_TRUE(scheduler.rests());
  EXPECT_FALSE(scheduler.next(1e6).has_value());
}

// 2026-11-22: the first image was as large as the window, and took seconds on two cores.
TEST(RenderScheduler, BeginsSmallAndGrowsWithoutMuchMoreThanTheFullPictureTakes) {
  for (const double full_s : {0.3, 1.0, 4.0, 20.0}) {
    RenderScheduler scheduler(home(), 0.06);
    double now_s = 0, sum_s = 0;
    const auto orders = fly(scheduler, now_s, 100, full_s);
    EXPECT_LE(orders.front().share, 0.125) << full_s;
    EXPECT_FALSE(orders.front().in_tiles);
    EXPECT_GT(orders.front().roots_s, 0) << "the first preview may wait while cells have no data";
    for (std::size_t i = 1; i < orders.size(); ++i) {
      EXPECT_GT(orders[i].share, orders[i - 1].share) << full_s;
      EXPECT_EQ(orders[i].roots_s, 0) << full_s;
      EXPECT_EQ(orders[i].pose, orders[0].pose);
    }
    for (const auto& order : orders) sum_s += full_s * order.share * order.share;
    EXPECT_LT(sum_s, 1.25 * full_s) << full_s;
    EXPECT_TRUE(orders.back().in_tiles) << full_s;
  }
}

// 2026-11-22: at rest, a frame waited a quarter of a second for new data, and again as long to cast missing rays.
TEST(RenderScheduler, GivesNewDataMoreTimeTheLongerItRests) {
  RenderScheduler scheduler(home(), 0.06);
  double before_s = 0;
  for (double now_s = 0; now_s < 0.5; now_s += 0.05) {
    const auto order = scheduler.next(now_s);
    ASSERT_TRUE(order.has_value());
    EXPECT_FALSE(order->in_tiles);
    EXPECT_GE(order->upload_s, before_s);
    EXPECT_NEAR(order->upload_s, std::max(now_s, scheduler.upload_s()), 1e-9);
    before_s = order->upload_s;
    FrameStats stats = took(0.05, false);
    stats.uploads = 100;
    scheduler.drawn(*order, stats);
  }
  scheduler.steer(turning(0.1), 0.6);
  EXPECT_EQ(scheduler.next(0.6)->upload_s, scheduler.upload_s());
}

TEST(RenderScheduler, GoesOnToTilesWhereAPoolIsTooSmallForASketchToBecomeComplete) {
  RenderScheduler scheduler(home(), 0.06);
  FrameStats stats = took(0.06, false);
  stats.uploads = 10;
  stats.starved = true;
  const auto sketch = scheduler.next(0);
  scheduler.drawn(*sketch, stats);
  EXPECT_TRUE(scheduler.next(0.1)->in_tiles);
}

TEST(RenderScheduler, SketchesWholeFramesWhereTheyAreQuick) {
  RenderScheduler scheduler(home(), 0.06);
  double now_s = 0;
  fly(scheduler, now_s, 10, 0.004);
  scheduler.steer(turning(0.1), now_s);
  for (const auto& order : fly(scheduler, now_s, now_s + 10, 0.004)) EXPECT_TRUE(order.full && !order.in_tiles);
  EXPECT_TRUE(scheduler.rests());
}

TEST(RenderScheduler, DrawsAgainUntilTheFrameIsComplete) {
  RenderScheduler scheduler(home(), 0.05);
  int full_orders = 0;
  for (int i = 0; i < 60; ++i) {
    const auto order = scheduler.next(i);
    ASSERT_TRUE(order.has_value());
    EXPECT_FALSE(scheduler.rests());
    full_orders += order->full ? 1 : 0;
    FrameStats stats = took(0.1, i % 10 == 9);
    stats.uploads = 1;
    scheduler.drawn(*order, stats);
    if (scheduler.rests()) break;
  }
  EXPECT_TRUE(scheduler.rests());
  EXPECT_GE(full_orders, 10);
  EXPECT_FALSE(scheduler.next(60).has_value());
}

TEST(RenderScheduler, DrawsSmallWhileItMovesAndFullWhenItRests) {
  RenderScheduler scheduler(home(), 0.05);
  double now_s = 0;
  fly(scheduler, now_s, 5, 0.8);
  for (int i = 0; i < 30; ++i) {
    scheduler.steer(turning(0.01), now_s);
    const double from_s = now_s;
    for (const auto& order : fly(scheduler, now_s, now_s + 0.06, 0.8)) EXPECT_FALSE(order.full);
    now_s = std::max(now_s, from_s + 0.06);
  }
  scheduler.steer(turning(0.01), now_s);
  const auto last = fly(scheduler, now_s, now_s + 5, 0.8);
  ASSERT_GE(last.size(), 2u);
  // A full frame takes 0.8 s. A preview that may take 0.05 s therefore has a quarter of the edge.
  EXPECT_NEAR(last.front().share, 0.25, 0.07);
  EXPECT_TRUE(last.back().full);
  EXPECT_EQ(last.back().view.camera.eye_m, last.front().view.camera.eye_m);
  EXPECT_TRUE(scheduler.rests());
}

TEST(RenderScheduler, WalksWhileAKeyIsHeldAndLetsGoWhenNobodyConfirmsIt) {
  RenderScheduler scheduler(home(), 0.05);
  double now_s = 0;
  fly(scheduler, now_s, 2, 0.01);
  const double start_y = scheduler.controller().pose().eye_m.y, speed = scheduler.controller().speed_m_per_s();
  now_s = 2;
  scheduler.next(now_s);
  scheduler.steer(walk(1), now_s);
  fly(scheduler, now_s, 20, 0.01);
  const Point<Scene> eye = scheduler.controller().pose().eye_m;
  const double way = std::hypot(eye.x, eye.y - start_y, eye.z - 50);
  EXPECT_NEAR(way, speed * RenderScheduler::max_hold_s, speed * 0.05);
  EXPECT_TRUE(scheduler.rests());
}

TEST(RenderScheduler, StopsWhenTheKeyIsReleased) {
  RenderScheduler scheduler(home(), 0.05);
  scheduler.steer(walk(1), 10);
  scheduler.next(10.1);
  scheduler.steer(walk(0), 10.2);
  const CameraPose pose = scheduler.controller().pose();
  double now_s = 10.2;
  fly(scheduler, now_s, 30, 0.01);
  EXPECT_EQ(scheduler.controller().pose(), pose);
  EXPECT_TRUE(scheduler.rests());
}

TEST(RenderScheduler, WhatIsSteeredWhileAFrameIsDrawnIsDrawnNext) {
  RenderScheduler scheduler(home(), 0.05);
  const auto order = scheduler.next(0);
  ViewerInput mode;
  mode.mode = ViewMode::albedo;
  scheduler.steer(mode, 0.01);
  scheduler.drawn(*order, took(0.1, true));
  EXPECT_FALSE(scheduler.rests());
  const auto after = scheduler.next(0.2);
  ASSERT_TRUE(after.has_value());
  EXPECT_EQ(after->view.mode, ViewMode::albedo);
}

TEST(RenderScheduler, DoesNotTryAgainWhatFailedUntilSomethingChanges) {
  RenderScheduler scheduler(home(), 0.05);
  ASSERT_TRUE(scheduler.next(0).has_value());
  scheduler.failed();
  EXPECT_FALSE(scheduler.next(1).has_value());
  scheduler.steer(turning(0.1), 2);
  EXPECT_TRUE(scheduler.next(2).has_value());
}

TEST(RenderScheduler, ANewSceneIsDrawnFromWhereTheViewerHasGone) {
  RenderScheduler stays(home(), 0.05), gone(home(), 0.05);
  gone.steer(turning(0.1), 1);
  const CameraPose pose = gone.controller().pose();
  CameraOptions other = home();
  other.eye_m = Point<Scene>{0, -200, 90};
  stays.new_scene(other);
  gone.new_scene(other);
  EXPECT_EQ(stays.controller().pose().eye_m, *other.eye_m);
  EXPECT_EQ(gone.controller().pose(), pose);
  EXPECT_TRUE(gone.next(5).has_value());
}

TEST(RenderScheduler, AsksForSoundPicturesWhateverIsSteered) {
  std::mt19937_64 random(3);
  const double odd[] = {NAN, HUGE_VAL, -1e308, 0, 1, -1, 1e9, 0.01};
  const auto any = [&] { return odd[random() % std::size(odd)]; };
  RenderScheduler scheduler(home(), NAN);
  for (int i = 0; i < 20000; ++i) {
    ViewerInput s;
    s.turn = {any(), any()};
    s.pan = {any(), any()};
    s.zoom = any();
    s.walk = std::array<double, 3>{any(), any(), any()};
    s.swing = std::array<double, 2>{any(), any()};
    s.pixel_error = any();
    s.upload_s = any();
    s.mode = ViewMode(random() % 256);
    s.sun = std::array<double, 2>{any(), any()};
    s.shadows = Shadows(random() % 256);
    s.level_blend = LevelBlend(random() % 256);
    s.size = std::array<int, 2>{int(random()), int(random())};
    if (random() % 4 == 0) s.pose = CameraPose{{any(), any(), any()}, {any(), any(), any()}};
    scheduler.steer(s, i * 0.01);
    const auto order = scheduler.next(i * 0.01);
    ASSERT_TRUE(order.has_value());
    const CameraOptions& c = order->view.camera;
    ASSERT_TRUE(c.width >= 1 && c.width <= 4096 && c.height >= 1 && c.height <= 4096);
    ASSERT_TRUE(c.pixel_error >= 0x1p-16 && c.pixel_error <= 0x1p16 && order->upload_s >= 1e-4 && order->upload_s <= 1);
    ASSERT_LT(std::size_t(order->view.mode), names_of<ViewMode>().size());
    const SunDirection& sun = order->view.sun;
    ASSERT_TRUE(std::fabs(sun.azimuth_deg) <= 360 && std::fabs(sun.elevation_deg) <= 90);
    ASSERT_TRUE(std::size_t(order->view.shadows) < 2 && std::size_t(order->view.level_blend) < 2);
    ASSERT_FALSE(*c.eye_m == *c.target_m);
    scheduler.drawn(*order, took(any(), random() % 2 == 0));
  }
}

TEST(FrameBudget, FindsTheSizeThatTakesTheTimeAsked) {
  for (const double full_s : {0.001, 0.04, 0.2, 0.8, 3.0}) {
    FrameBudget pace(0.05);
    for (int i = 0; i < 60; ++i) pace.took(full_s * pace.share() * pace.share(), pace.share());
    const double ideal = std::clamp(std::sqrt(0.05 / full_s), FrameBudget::min_share, 1.0);
    EXPECT_LE(pace.share(), ideal + 1e-9) << full_s;
    EXPECT_GT(pace.share(), ideal / 1.3) << full_s;
  }
}

TEST(FrameBudget, DoesNotFlickerWhereTimesScatter) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> scatter(0.97, 1.03);
  FrameBudget pace(0.05);
  int changes = 0;
  for (int i = 0; i < 300; ++i) {
    const double before = pace.share();
    pace.took(0.4 * before * before * scatter(random), before);
    changes += i > 30 && pace.share() != before;
  }
  EXPECT_LE(changes, 6);
}

}  // namespace
}  // namespace gigabake
