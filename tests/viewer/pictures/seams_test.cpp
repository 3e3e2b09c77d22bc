// A scene that is one cell gives the same images as the same scene cut into 4 × 4 cells.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "tests/viewer/voxel_scene.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake {
namespace {

constexpr int scene_edge = 256;
constexpr int picture_edge = 160;         ///< edge of an image in pixels
constexpr int min_coverage_divisor = 32;  ///< the scene covers at least 1/32 of the pixels; from afar about 1/15

/// Paints rolling ground, two voxels thick, and posts that cross the borders of cells.
std::optional<Paint> landscape(std::int64_t x, std::int64_t y, std::int64_t z) {
  const double ground = 28 + 12 * std::sin(double(x) / 21) + 9 * std::cos(double(y) / 17);
  const bool post = x % 32 < 2 && y % 32 < 2 && double(z) < ground + 14;
  if (double(z) < ground - 2 || (double(z) >= ground && !post)) return {};
  const auto tilt = std::int8_t(40 * std::cos(double(x) / 21));
  return Paint{{std::uint8_t(60 + x / 2), std::uint8_t(90 + (x ^ y) % 64), std::uint8_t(200 - y / 2), 255}, {tilt, 0}};
}

VoxelScene cut_into(std::uint32_t cell_voxels) {
  VoxelScene scene(cell_voxels);
  for (std::int64_t y = 0; y < scene_edge; y += cell_voxels)
    for (std::int64_t x = 0; x < scene_edge; x += cell_voxels) scene.add_cell(landscape, {x, y, 0});
  return scene;
}

/// A view that shows levels up to 3, the coarsest level of the small cells.
struct Place {
  std::array<double, 3> eye_m, target_m;
  double pixel_error;
};
const Place places[] = {
    {{20, 30, 75}, {90, 100, 30}, 1},      // near, level 0
    {{100, 92, 85}, {128, 140, 20}, 4},    // near, levels 0 to 2 across borders
    {{128, 120, 95}, {128, 128, 20}, 16},  // near, levels 2 and 3
    {{-500, -420, 420}, {128, 128, 0}, 1}, {{-500, -420, 420}, {128, 128, 0}, 2.5},  // far, level 3
};

FrameRenderer renderer_of(const VoxelScene& scene) {
  FrameRenderer::Options options;
  options.threads = 2;
  options.memory_bytes = std::uint64_t(1) << 28;
  return FrameRenderer(scene.description(), "scene.xml", scene.pages(), options);
}

/// Returns the number of pixels that show the scene. Tests require a minimum, because two empty images are equal, too.
std::size_t covered_pixels(const Picture& picture) {
  std::size_t covered = 0;
  for (std::size_t i = 3; i < picture.rgba.size(); i += 4) covered += picture.rgba[i] != 0;
  return covered;
}

int max_difference(const Picture& a, const Picture& b) {
  EXPECT_EQ(a.rgba.size(), std::size_t(picture_edge) * picture_edge * 4);
  EXPECT_EQ(a.rgba.size(), b.rgba.size());
  EXPECT_GT(covered_pixels(a), a.rgba.size() / 4 / min_coverage_divisor) << "the image is nearly empty";
  int maximum = 0;
  for (std::size_t i = 0; i < std::min(a.rgba.size(), b.rgba.size()); ++i)
    maximum = std::max(maximum, std::abs(a.rgba[i] - b.rgba[i]));
  return maximum;
}

/// Returns the difference of two depths in voxels; infinity if one is NaN or only one of the rays hits the scene.
float difference(float a, float b) {
  if (a == b) return 0;
  const bool both_met = a < kernels::CastRay::no_depth && b < kernels::CastRay::no_depth;
  return both_met ? std::fabs(a - b) : std::numeric_limits<float>::infinity();
}

TEST(Seams, AreNotSeenBetweenCellsInAnyModeFromNearAndFar) {
  const VoxelScene one = cut_into(256), sixteen = cut_into(64);
  ASSERT_EQ(one.description().cells.size(), 1u);
  ASSERT_EQ(sixteen.description().cells.size(), 16u);
  FrameRenderer whole = renderer_of(one), parts = renderer_of(sixteen);
  for (const ViewMode mode :
       {ViewMode::lit, ViewMode::albedo, ViewMode::normal, ViewMode::coverage, ViewMode::lod, ViewMode::requests})
    for (const Place& place : places) {
      View there{view(place.eye_m, place.target_m, picture_edge).camera, mode, {false, {0, 0, 0, 0}}};
      there.camera.pixel_error = place.pixel_error;
      EXPECT_LE(max_difference(whole.render_complete(there).picture, parts.render_complete(there).picture), 2)
          << name_of(mode) << " from " << place.eye_m[0] << ", pixel error " << place.pixel_error;
    }
}

TEST(Seams, LeaveNoHoleInDepthFromNearAndFar) {
  const VoxelScene one = cut_into(256), sixteen = cut_into(64);
  for (const Place& place : places) {
    PictureOptions options = view(place.eye_m, place.target_m, picture_edge);
    options.camera.pixel_error = place.pixel_error;
    const std::vector<float> a = take(one, options).depth, b = take(sixteen, options).depth;
    ASSERT_EQ(a.size(), std::size_t(picture_edge) * picture_edge);
    ASSERT_EQ(b.size(), a.size());
    float maximum = 0;
    std::size_t met = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      met += a[i] < kernels::CastRay::no_depth;
      maximum = std::max(maximum, difference(a[i], b[i]));
    }
    EXPECT_LE(maximum, 1e-3f) << "voxels, pixel error " << place.pixel_error;
    EXPECT_GT(met, a.size() / min_coverage_divisor)
        << "next to nothing of the scene was met; pixel error " << place.pixel_error;
  }
}

}  // namespace
}  // namespace gigabake
