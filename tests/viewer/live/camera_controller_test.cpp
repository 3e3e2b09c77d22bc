#include "viewer/live/camera_controller.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace gigabake {
namespace {

using Style = CameraController::Style;

const CameraPose rig_home{{60, -80, 50}, {0, 0, 0}};

double apart_m(const Point<Scene>& a, const Point<Scene>& b) { return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z); }
double apart_m(const CameraController& controller) {
  return apart_m(controller.pose().eye_m, controller.pose().target_m);
}
double steepness_deg(const CameraPose& p) {
  const double flat = std::hypot(p.target_m.x - p.eye_m.x, p.target_m.y - p.eye_m.y);
  return std::fabs(std::atan2(p.target_m.z - p.eye_m.z, flat)) * 180 / M_PI;
}

void expect_sound(const CameraController& controller, double size_m, const Point<Scene>& middle) {
  const CameraPose& p = controller.pose();
  for (const double v : {p.eye_m.x, p.eye_m.y, p.eye_m.z, p.target_m.x, p.target_m.y, p.target_m.z})
    ASSERT_TRUE(std::isfinite(v));
  ASSERT_TRUE(std::isfinite(controller.speed_m_per_s()) && controller.speed_m_per_s() > 0);
  ASSERT_FALSE(p.eye_m == p.target_m);
  ASSERT_LE(steepness_deg(p), CameraController::max_pitch_deg + 0.01);
  ASSERT_LE(apart_m(p.eye_m, middle), CameraController::max_distance_sizes * size_m * (1 + 1e-6));
}

/// Returns arbitrary input: special values or numbers of random magnitude.
double wild(std::mt19937_64& random) {
  static const double odd[] = {NAN, HUGE_VAL, -HUGE_VAL, 0, -0.0, 1e308, -1e308, 5e-324, 1e-9, 1, -1};
  const auto pick = random() % 20;
  return pick < std::size(odd) ? odd[pick] : std::ldexp(double(random() % 2001) - 1000, int(random() % 20) - 16);
}

void do_something(CameraController& controller, std::mt19937_64& random) {
  const auto w = [&] { return wild(random); };
  switch (random() % 8) {
    case 0:
      return controller.turn(w(), w());
    case 1:
      return controller.pan(w(), w(), w());
    case 2:
      return controller.zoom(w());
    case 3:
      return controller.walk(w(), w(), w(), w());
    case 4:
      return controller.set_pose({{w(), w(), w()}, {w(), w(), w()}});
    case 5:
      return controller.set_style(random() % 2 == 0 ? Style::fly : Style::orbit);
    case 6:
      return controller.pan(w(), w(), 40);
    default:
      return controller.turn(w() / 8, w() / 8);
  }
}

TEST(CameraController, StaysSoundWhateverIsAskedOfIt) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    CameraController controller(rig_home);
    for (int step = 0; step < 300; ++step) {
      do_something(controller, random);
      ASSERT_NO_FATAL_FAILURE(expect_sound(controller, apart_m(rig_home.eye_m, rig_home.target_m), rig_home.target_m));
    }
  }
}

TEST(CameraController, FindsAHomeWhereItIsGivenNone) {
  for (const CameraPose& bad :
       {CameraPose{{NAN, 0, 0}, {0, 0, 0}}, CameraPose{{1, 2, 3}, {1, 2, 3}}, CameraPose{{1e300, 0, 0}, {0, 0, 0}}}) {
    const CameraController controller(bad);
    EXPECT_GT(apart_m(controller), 1);
    EXPECT_LT(apart_m(controller), 1000);
  }
}

TEST(CameraController, KeepsItsDistanceFromCoordinatesThatSwallowSmallSteps) {
  CameraController controller({{1e11, 1e11, 1e-3}, {1e11, 1e11, 0}});
  controller.zoom(100);
  controller.zoom(100);
  EXPECT_FALSE(controller.pose().eye_m == controller.pose().target_m);
}

TEST(CameraController, GivesBackAPoseThatWasSet) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> anywhere(-100, 100);
  for (int i = 0; i < 1000; ++i) {
    CameraController controller(rig_home);
    const CameraPose pose{{anywhere(random), anywhere(random), anywhere(random)},
                          {anywhere(random), anywhere(random), anywhere(random)}};
    if (steepness_deg(pose) > CameraController::max_pitch_deg - 0.1) continue;
    controller.set_pose(pose);
    EXPECT_EQ(controller.pose(), pose);
  }
}

TEST(CameraController, OrbitsAroundTheTargetAtOneDistance) {
  CameraController controller(rig_home);
  const double before = apart_m(controller);
  for (int i = 0; i < 1000; ++i) controller.turn(0.013, i % 2 == 0 ? 0.05 : -0.049);
  EXPECT_EQ(controller.pose().target_m.z, controller.pose().target_m.z);
  EXPECT_NEAR(apart_m(controller.pose().target_m, rig_home.target_m), 0, 1e-6);
  EXPECT_NEAR(apart_m(controller), before, 1e-6);
}

TEST(CameraController, IsBackAfterAWholeTurn) {
  CameraController controller(rig_home);
  for (int i = 0; i < 8; ++i) controller.turn(0.25, 0);
  EXPECT_NEAR(apart_m(controller.pose().eye_m, rig_home.eye_m), 0, 1e-9);
}

TEST(CameraController, LooksAroundFromWhereItStandsInFlight) {
  CameraController controller(rig_home);
  controller.set_style(Style::fly);
  controller.turn(0.4, 0.1);
  EXPECT_EQ(controller.pose().eye_m, rig_home.eye_m);
  EXPECT_GT(apart_m(controller.pose().target_m, rig_home.target_m), 1);
}

TEST(CameraController, DraggingRightTurnsTheViewRightAndDraggingUpLowersTheOrbit) {
  CameraController controller({{0, -100, 50}, {0, 0, 0}});
  controller.turn(0.1, 0);
  EXPECT_LT(controller.pose().eye_m.x, 0);  // the near side follows the mouse to the east
  controller.go_home();
  controller.turn(0, 0.05);
  EXPECT_LT(controller.pose().eye_m.z, 50);
  controller.go_home();
  controller.set_style(Style::fly);
  controller.turn(0.1, 0.1);
  EXPECT_GT(controller.pose().target_m.x, 0);
  EXPECT_GT(controller.pose().target_m.z, 0);
}

TEST(CameraController, PanningKeepsWhatIsDraggedUnderTheMouse) {
  CameraController controller({{0, -100, 0}, {0, 0, 0}});
  controller.pan(0.5, 0.25, 90);  // 90° at 100 m: the image is 200 m high
  EXPECT_NEAR(controller.pose().target_m.x, -100, 1e-9);
  EXPECT_NEAR(controller.pose().target_m.z, -50, 1e-9);
  EXPECT_NEAR(apart_m(controller), 100, 1e-9);
}

TEST(CameraController, ZoomingComesNearerByATenthANotch) {
  CameraController controller(rig_home);
  const double before = apart_m(controller);
  controller.zoom(1);
  EXPECT_NEAR(apart_m(controller), before * 0.9, 1e-9);
  EXPECT_NEAR(apart_m(controller.pose().target_m, rig_home.target_m), 0, 1e-9);
  controller.zoom(-1);
  EXPECT_NEAR(apart_m(controller), before, 1e-9);
}

TEST(CameraController, WalksAsFarAsSpeedAndTimeSayAndFasterInLargerScenes) {
  for (const double scale : {0.01, 1.0, 1000.0}) {
    CameraController controller({{0, -100 * scale, 0}, {0, 0, 0}});
    EXPECT_NEAR(controller.speed_m_per_s(), 25 * scale, 1e-9 * scale);
    controller.walk(1, 0, 0, 0.1);
    EXPECT_NEAR(controller.pose().eye_m.y, -97.5 * scale, 1e-9 * scale);
    EXPECT_NEAR(controller.pose().target_m.y, 2.5 * scale, 1e-9 * scale);
  }
}

TEST(CameraController, APauseIsNoJump) {
  CameraController slow(rig_home), paused(rig_home);
  slow.walk(1, 0, 0, 0.25);
  paused.walk(1, 0, 0, 3600);
  EXPECT_EQ(slow.pose(), paused.pose());
}

TEST(CameraController, StepsAddUpToTheSameWay) {
  CameraController fine(rig_home), coarse(rig_home);
  for (int i = 0; i < 200; ++i) fine.walk(0.5, 0.3, 0.2, 0.001);
  coarse.walk(0.5, 0.3, 0.2, 0.2);
  EXPECT_NEAR(apart_m(fine.pose().eye_m, coarse.pose().eye_m), 0, 1e-6);
}

}  // namespace
}  // namespace gigabake
