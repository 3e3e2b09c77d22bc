#include "viewer/pictures/camera.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "core/base/error.h"
#include "tests/viewer/voxel_scene.h"

namespace gigabake {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = HUGE_VAL;

/// Returns ground that rises to the north, 64 m wide.
const VoxelScene& hillside() {
  static const VoxelScene scene = [] {
    VoxelScene made(64);
    made.add_cell([](std::int64_t, std::int64_t y,
                     std::int64_t z) { return z == 10 + y / 2 ? std::optional<Paint>(Paint{}) : std::nullopt; },
                  {0, 0, 0});
    return made;
  }();
  return scene;
}

kernels::CastCamera camera_of(const CameraOptions& options) { return make_camera(options, hillside().paged()); }

std::string complaint(const CameraOptions& options) {
  try {
    camera_of(options);
  } catch (const UsageError& e) {
    return e.what();
  }
  return "none";
}

CameraOptions looking_down() {
  CameraOptions options;
  options.eye_m = Point<Scene>{32, 32, 200};
  options.target_m = Point<Scene>{32, 32, 20};
  return options;
}

TEST(Camera, NamesTheOptionThatIsNoPlace) {
  for (const double bad : {nan, infinity, -infinity, 1e300}) {
    CameraOptions options = looking_down();
    options.eye_m->y = bad;
    EXPECT_THAT(complaint(options), testing::StartsWith("`eye_m`: "));
    options = looking_down();
    options.target_m->z = bad;
    EXPECT_THAT(complaint(options), testing::StartsWith("`target_m`: "));
  }
}

TEST(Camera, RefusesToLookNowhere) {
  CameraOptions options = looking_down();
  options.target_m = options.eye_m;
  EXPECT_THAT(complaint(options), testing::StartsWith("`target_m`: the same place"));
}

TEST(Camera, RefusesAnUpDirectionThatIsNone) {
  for (const Point<Scene>& up : {Point<Scene>{0, 0, 0}, {nan, 0, 1}, {infinity, 0, 0}, {0, 0, 1}, {0, 0, -3}}) {
    CameraOptions options = looking_down();
    options.up = up;
    EXPECT_THAT(complaint(options), testing::StartsWith("`up`: "));
  }
}

TEST(Camera, RefusesPicturesThatAreNone) {
  const std::pair<int, int> sizes[] = {{0, 10}, {10, 0}, {-5, 10}, {32769, 1}, {32768, 32768}, {1 << 30, 1 << 30}};
  for (const auto& [width, height] : sizes) {
    CameraOptions options = looking_down();
    options.width = width;
    options.height = height;
    EXPECT_THAT(complaint(options), testing::StartsWith("`size`: ")) << width << "x" << height;
  }
}

TEST(Camera, RefusesAnglesAndPixelErrorsOutOfRange) {
  for (const double bad : {nan, 0.0, -40.0, 180.0, 1e9, infinity}) {
    CameraOptions options = looking_down();
    options.fovy_deg = bad;
    EXPECT_THAT(complaint(options), testing::StartsWith("`fovy_deg`: "));
  }
  for (const double bad : {nan, 0.0, -1.0, 0x1p-17, 0x1p17, infinity}) {
    CameraOptions options = looking_down();
    options.pixel_error = bad;
    EXPECT_THAT(complaint(options), testing::StartsWith("`pixel_error`: "));
  }
}

TEST(Camera, HasNorthUpWhereItLooksStraightDown) {
  const kernels::CastCamera camera = camera_of(looking_down());
  EXPECT_GT(camera.up[1], 0);
  EXPECT_NEAR(camera.up[0], 0, 1e-12);
  EXPECT_GT(camera.right[0], 0);
}

/// The rows and columns of the image that show the scene.
struct Extent {
  int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
};

Extent extent_of(const Picture& p) {
  Extent e;
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x)
      if (p.rgba[std::size_t(4 * (y * p.width + x) + 3)] != 0) {
        e.left = std::min(e.left, x);
        e.right = std::max(e.right, x);
        e.top = std::min(e.top, y);
        e.bottom = std::max(e.bottom, y);
      }
  return e;
}

TEST(Camera, FramesTheWholeSceneFromTheSouthEastWhereNobodySaysOtherwise) {
  for (const auto& [width, height] : {std::pair{160, 90}, std::pair{90, 160}, std::pair{120, 120}}) {
    PictureOptions options;
    options.camera.width = width;
    options.camera.height = height;
    const Extent e = extent_of(take(hillside(), options));
    EXPECT_GT(e.left, 0);
    EXPECT_GT(e.top, 0);
    EXPECT_LT(e.right, width - 1);
    EXPECT_LT(e.bottom, height - 1);
    EXPECT_TRUE(e.right - e.left > width * 0.75 || e.bottom - e.top > height * 0.75);
    const kernels::CastCamera camera = camera_of(options.camera);
    EXPECT_GT(camera.eye[0], 64);
    EXPECT_LT(camera.eye[1], 0);
    EXPECT_GT(camera.eye[2], 42);
  }
}

TEST(Camera, LooksAtTheMiddleOfTheSceneFromAGivenEye) {
  CameraOptions options;
  options.eye_m = Point<Scene>{-500, 32, 28};
  const kernels::CastCamera camera = camera_of(options);
  EXPECT_NEAR(camera.forward[0], 1, 1e-3);
}

}  // namespace
}  // namespace gigabake
