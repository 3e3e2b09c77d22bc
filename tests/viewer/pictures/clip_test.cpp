// Clipped images: the shown part is unchanged, the clipped part is absent.
#include <cmath>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "kernels/marching/cast_line.h"
#include "tests/viewer/ground_scene.h"

namespace gigabake {
namespace {

PictureOptions clipped_view(const Clip& clip) {
  PictureOptions options = view({64, 20, 90}, {64, 64, 10});
  options.camera.clip = clip;
  return options;
}

/// Returns x and y of the ground point, at height 13, that pixel i of the view shows.
std::array<double, 2> place_seen(const VoxelScene& scene, const PictureOptions& options, std::size_t i) {
  const kernels::CastCamera camera = make_camera(options.camera, scene.paged());
  kernels::CastScene nothing;
  const auto width = std::size_t(camera.width);
  const kernels::CastLine line = kernels::line_of_sight(nothing, camera, int(i % width), int(i / width));
  const double to_ground = (13 - line.origin[2]) / line.direction[2];
  return {line.origin[0] + line.direction[0] * to_ground, line.origin[1] + line.direction[1] * to_ground};
}

/// Expects the clipped image to be correct. The callback shown(x, y) returns the distance from a ground point to the
/// border of the shown part, in voxels. The distance is negative outside of the shown part.
template <class Shown>
void expect_clipped(const Clip& clip, const Shown& shown) {
  const VoxelScene scene = wide_ground();
  const PictureOptions whole = clipped_view({}), options = clipped_view(clip);
  const Picture before = take(scene, whole), after = take(scene, options);
  int kept = 0, gone = 0;
  for (std::size_t i = 0; i < after.rgba.size() / 4; ++i) {
    const std::array<double, 2> at = place_seen(scene, whole, i);
    const double inside = shown(at[0], at[1]);
    if (inside > 6) {
      ++kept;
      for (std::size_t k = 0; k < 4; ++k) ASSERT_NEAR(after.rgba[4 * i + k], before.rgba[4 * i + k], 2) << i;
    } else if (inside < -6) {
      ++gone;
      ASSERT_EQ(after.rgba[4 * i + 3], 0) << i;
    }
  }
  EXPECT_GT(kept, 500);
  EXPECT_GT(gone, 500);
}

TEST(Clip, ShowsWhatIsInTheBoxAlone) {
  const Clip clip{.box_m = {{Point<Scene>{50, 40, -5}, Point<Scene>{90, 80, 60}}}, .plane = {}};
  expect_clipped(clip,
                 [](double x, double y) { return std::fmin(std::fmin(x - 50, 90 - x), std::fmin(y - 40, 80 - y)); });
}

TEST(Clip, ShowsWhatIsBeyondThePlaneAlone) {
  const Clip clip{.box_m = {}, .plane = ClipPlane{{64, 64, 0}, {2, 1, 0}}};
  expect_clipped(clip, [](double x, double y) { return (2 * (x - 64) + (y - 64)) / std::sqrt(5.0); });
}

TEST(Clip, OfEverythingChangesNoByte) {
  const VoxelScene scene = wide_ground();
  const Clip all{.box_m = {{Point<Scene>{-500, -500, -500}, Point<Scene>{500, 500, 500}}},
                 .plane = ClipPlane{{0, 0, -300}, {0, 0, 3}}};
  EXPECT_EQ(take(scene, clipped_view({})).rgba, take(scene, clipped_view(all)).rgba);
}

TEST(Clip, RefusesBoxesAndPlanesThatMeanNothing) {
  const VoxelScene scene = wide_ground();
  const double nan = std::nan("");
  for (const Clip& clip : {Clip{.box_m = {{Point<Scene>{5, 0, 0}, Point<Scene>{5, 9, 9}}}, .plane = {}},
                           Clip{.box_m = {{Point<Scene>{nan, 0, 0}, Point<Scene>{5, 9, 9}}}, .plane = {}},
                           Clip{.box_m = {}, .plane = ClipPlane{{0, 0, 0}, {0, 0, 0}}},
                           Clip{.box_m = {}, .plane = ClipPlane{{0, nan, 0}, {0, 0, 1}}}})
    EXPECT_THROW(make_camera(clipped_view(clip).camera, scene.paged()), UsageError);
}

}  // namespace
}  // namespace gigabake
