#include "viewer/live/camera_path.h"

#include <cmath>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "viewer/live/path_frames.h"

namespace gigabake {
namespace {

using testing::HasSubstr;

CameraKeyframe key(double time_s, const Point<Scene>& eye, const Point<Scene>& target) {
  return {time_s, {eye, target}, std::nullopt, std::nullopt};
}

std::vector<CameraKeyframe> random_keyframes(unsigned seed, int count) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-500, 500), pause(0.01, 5);
  std::vector<CameraKeyframe> out;
  double time_s = place(random);
  for (int i = 0; i < count; ++i) {
    out.push_back(
        key(time_s, {place(random), place(random), place(random)}, {place(random), place(random), place(random)}));
    if (i % 3 == 1) out.back().fovy_deg = 20 + i;
    if (i % 4 == 2) out.back().up = Point<Scene>{0.1, 0, 1};
    time_s += pause(random);
  }
  return out;
}

double distance(const Point<Scene>& a, const Point<Scene>& b) { return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z); }

TEST(CameraPath, PassesThroughItsKeyframes) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const CameraPath path(random_keyframes(seed, 1 + int(seed % 9)));
    for (const CameraKeyframe& k : path.keyframes()) {
      const CameraOptions there = path.at(k.time_s, {});
      EXPECT_EQ(*there.eye_m, k.pose.eye_m) << seed;
      EXPECT_EQ(*there.target_m, k.pose.target_m) << seed;
      EXPECT_EQ(there.fovy_deg, k.fovy_deg.value_or(CameraOptions().fovy_deg)) << seed;
    }
  }
}

TEST(CameraPath, MakesNoJumpsAndNoCorners) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const CameraPath path(random_keyframes(seed, 6));
    const double step_s = 1e-6;
    for (std::size_t i = 1; i + 1 < path.keyframes().size(); ++i) {
      const double t = path.keyframes()[i].time_s;
      const auto eye = [&](double time_s) { return *path.at(time_s, {}).eye_m; };
      const double before = (eye(t).x - eye(t - step_s).x) / step_s, after = (eye(t + step_s).x - eye(t).x) / step_s;
      EXPECT_NEAR(before, after, 1e-2 * (1 + std::fabs(before))) << seed;
    }
  }
}

TEST(CameraPath, FollowsAStraightLineAtItsSpeedWhateverTheKeyframesTimes) {
  std::vector<CameraKeyframe> keys;
  for (const double t : {0.0, 0.1, 3.0, 3.5, 10.0}) keys.push_back(key(t, {2 * t, -t, 5}, {2 * t, 100, 0}));
  const CameraPath path(keys);
  for (double t = 0; t <= 10; t += 0.0625) {
    EXPECT_NEAR(path.at(t, {}).eye_m->x, 2 * t, 1e-9);
    EXPECT_NEAR(path.at(t, {}).eye_m->y, -t, 1e-9);
  }
}

TEST(CameraPath, FollowsAParabolaBetweenInnerKeyframes) {
  std::vector<CameraKeyframe> keys;
  for (const double t : {0.0, 1.0, 2.5, 3.0, 5.0}) keys.push_back(key(t, {t * t, 0, 0}, {0, 1000, 0}));
  const CameraPath path(keys);
  for (double t = 1; t <= 3; t += 0.03125) EXPECT_NEAR(path.at(t, {}).eye_m->x, t * t, 1e-9);
}

TEST(CameraPath, RestsBetweenEqualKeyframesBitForBit) {
  const Point<Scene> eye{0.1, -3.3, 7.7}, target{1e5 / 3, 0.2, -0.3};
  const CameraPath resting({key(0, eye, target), key(1, eye, target), key(7, eye, target)});
  const CameraPath pausing(
      {key(0, {9, 9, 9}, target), key(1, eye, target), key(2, eye, target), key(3, {0, 0, 0}, target)});
  for (double t = 1; t <= 2; t += 0.0101) {
    EXPECT_EQ(*resting.at(t * 3, {}).eye_m, eye);
    EXPECT_EQ(*resting.at(t * 3, {}).target_m, target);
    EXPECT_EQ(*pausing.at(t, {}).eye_m, eye);
  }
}

TEST(CameraPath, StopsBeforeAPauseWithoutRunningOverIt) {
  const CameraPath path({key(0, {0, 0, 0}, {0, 9, 0}), key(1, {10, 0, 0}, {0, 9, 0}), key(2, {10, 0, 0}, {0, 9, 0})});
  double last = 0;
  for (double t = 0; t <= 1; t += 0.01) {
    const double x = path.at(t, {}).eye_m->x;
    EXPECT_GE(x, last - 1e-12);
    EXPECT_LE(x, 10);
    last = x;
  }
}

TEST(CameraPath, StaysAtItsEndsOutsideOfItsTimes) {
  const CameraPath path({key(2, {0, 0, 0}, {0, 9, 0}), key(3, {10, 0, 0}, {0, 9, 0})});
  EXPECT_EQ(path.at(-1e9, {}).eye_m->x, 0);
  EXPECT_EQ(path.at(1e9, {}).eye_m->x, 10);
}

TEST(CameraPath, ComesBackFromJsonTheSame) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const CameraPath path(random_keyframes(seed, 5));
    EXPECT_EQ(camera_path_from_json("p.json", to_json(path), std::nullopt), path) << seed;
  }
}

TEST(CameraPath, ReadsDegreesWhereTheSceneStandsOnTheEarth) {
  const Geodetic origin{47.5, 8.5, 400};
  const char* text = R"({"coordinates": "geographic", "keyframes": [
    {"time_s": 0, "eye": [47.501, 8.5, 500], "target": [47.5, 8.5, 400]}]})";
  const CameraPath path = camera_path_from_json("p.json", text, origin);
  EXPECT_LT(distance(path.keyframes()[0].pose.target_m, {0, 0, 0}), 1e-6);
  EXPECT_NEAR(path.keyframes()[0].pose.eye_m.y, 111.2, 0.2);
  EXPECT_NEAR(path.keyframes()[0].pose.eye_m.z, 100, 0.01);
  EXPECT_THROW(camera_path_from_json("p.json", text, std::nullopt), InputError);
}

std::string complaint(const std::string& text) {
  try {
    camera_path_from_json("p.json", text, Geodetic{47, 8, 0});
  } catch (const InputError& e) {
    return e.what();
  }
  return "none";
}

TEST(CameraPath, NamesTheMemberThatIsWrongAndWhatWasExpected) {
  const auto one = [](const std::string& k) { return R"({"keyframes": [)" + k + "]}"; };
  EXPECT_THAT(complaint("["), HasSubstr("p.json: not valid JSON (at byte"));
  EXPECT_THAT(complaint("[]"), HasSubstr("expected a JSON object"));
  EXPECT_THAT(complaint("{}"), HasSubstr("keyframes: expected an array of at least one keyframe"));
  EXPECT_THAT(complaint(R"({"keyframes": 7})"), HasSubstr("keyframes: expected an array"));
  EXPECT_THAT(complaint(one("7")), HasSubstr("keyframes[0]: expected a JSON object"));
  EXPECT_THAT(complaint(one("{}")), HasSubstr("keyframes[0].time_s: is missing"));
  EXPECT_THAT(complaint(one(R"({"time_s": "0"})")), HasSubstr("keyframes[0].time_s: expected a number"));
  EXPECT_THAT(complaint(one(R"({"time_s": 1e999})")), HasSubstr("p.json: not valid JSON"));
  EXPECT_THAT(complaint(one(R"({"time_s": NaN})")), HasSubstr("p.json: not valid JSON"));
  EXPECT_THAT(complaint(one(R"({"time_s": 0})")), HasSubstr("keyframes[0].eye: is missing; expected [x, y, z]"));
  EXPECT_THAT(complaint(one(R"({"time_s": 0, "eye": [1, 2]})")), HasSubstr("keyframes[0].eye: expected an array of 3"));
  EXPECT_THAT(complaint(one(R"({"time_s": 0, "eye": [1, 2, 3], "target": [1, 2, 3]})")),
              HasSubstr("keyframes[0].target"));
  EXPECT_THAT(complaint(one(R"({"time_s": 0, "eye": [1, 2, 3], "target": [1, 2, 4], "speed": 1})")),
              HasSubstr("has an unknown member 'speed'; expected time_s"));
  EXPECT_THAT(complaint(one(R"({"time_s": 0, "eye": [1, 2, 3], "target": [1, 2, 4], "fovy_deg": 180})")),
              HasSubstr("fovy_deg: expected a number from 0.01 to 170"));
  const std::string good = R"({"time_s": 0, "eye": [1, 2, 3], "target": [1, 2, 4]})";
  EXPECT_THAT(complaint(one(good + "," + good)), HasSubstr("keyframes[1].time_s: expected more than"));
  EXPECT_THAT(complaint(one(R"({"time_s": 0, "time_s": 1})")), HasSubstr("keyframes.time_s: is there twice"));
  EXPECT_THAT(complaint(one(R"({"time_s": null})")), HasSubstr("keyframes[0].time_s: expected a number"));
  EXPECT_THAT(complaint(R"({"coordinates": "moon", "keyframes": []})"),
              HasSubstr("expected one of scene, lat_lon_height"));
  EXPECT_THAT(complaint(R"({"coordinates": "geographic", "keyframes": [{"time_s": 0, "eye": [91, 0, 0]}]})"),
              HasSubstr("keyframes[0].eye: expected [latitude, longitude, height]"));
}

TEST(PathRecorder, RecordsAWayThatPathsCanFollow) {
  PathRecorder recorder;
  EXPECT_FALSE(recorder.path().has_value());
  for (int i = 0; i <= 100; ++i) recorder.see({{i * 0.1, 0, 0}, {0, 9, 0}}, 50 + i * 0.033);
  const CameraPath path = *recorder.path();
  EXPECT_EQ(path.first_s(), 0);
  EXPECT_NEAR(path.last_s(), 3.3, 1e-9);
  EXPECT_EQ(path.keyframes().size(), 8u);
  EXPECT_NEAR(path.at(1.7, {}).eye_m->x, 1.7 / 0.33, 0.01);
}

TEST(PathFrames, StandsAtBothEndsOfThePath) {
  const CameraPath path({key(1, {0, 0, 0}, {0, 9, 0}), key(3, {10, 0, 0}, {0, 9, 0})});
  EXPECT_THAT(times_of_frames(path, 5), testing::ElementsAre(1, 1.5, 2, 2.5, 3));
  EXPECT_THAT(times_of_frames(path, 1), testing::ElementsAre(1));
  EXPECT_EQ(times_at_rate(path, 30).size(), 61u);
  EXPECT_EQ(times_at_rate(path, 30).back(), 3);
  EXPECT_EQ(times_at_rate(path, 0.4).size(), 1u);
  EXPECT_THROW(times_of_frames(path, 0), UsageError);
  for (const double bad : {0.0, -1.0, double(NAN), HUGE_VAL, 1e9}) EXPECT_THROW(times_at_rate(path, bad), UsageError);
}

TEST(PathFrames, NumbersFilesAsAsked) {
  EXPECT_EQ(numbered_file("frames/%04d.png", 7), "frames/0007.png");
  EXPECT_EQ(numbered_file("%d.png", 12), "12.png");
  EXPECT_EQ(numbered_file("a%01d", 123), "a123");
  for (const char* bad : {"a.png", "%s.png", "%d%d.png", "%04x.png", "%-4d.png", "%99d.png", "%", "%0d", "%*d"})
    EXPECT_THROW(numbered_file(bad, 1), UsageError) << bad;
}

}  // namespace
}  // namespace gigabake
