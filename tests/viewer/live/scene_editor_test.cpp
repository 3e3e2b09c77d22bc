#include "viewer/live/scene_editor.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <random>

#include "kernels/marching/cast_line.h"
#include "kernels/marching/pixel.h"
#include "viewer/live/cell_boxes.h"
#include "viewer/live/edit_brush.h"

namespace gigabake {
namespace {

constexpr int wall_pixels = 64;
constexpr float wall_distance = 100;

/// Returns the rays of a camera at (0, -100, 0) that looks north; the image spans 45° up, down and to each side.
PictureRays rays_to_north() {
  PictureRays rays;
  rays.camera.eye = {0, -100, 0};
  rays.camera.forward = {0, 1, 0};
  rays.camera.right = {1, 0, 0};
  rays.camera.up = {0, 0, 1};
  rays.camera.width = rays.camera.height = wall_pixels;
  rays.camera.lod1_depth = 1;
  return rays;
}

/// Returns a grey image of a wall around the eye; the upper half shows no surface.
Picture wall() {
  Picture picture;
  picture.width = picture.height = wall_pixels;
  picture.rgba.assign(std::size_t(4) * wall_pixels * wall_pixels, 128);
  picture.depth.assign(std::size_t(wall_pixels) * wall_pixels, wall_distance);
  std::fill_n(picture.depth.begin(), picture.depth.size() / 2, kernels::CastRay::no_depth);
  return picture;
}

TEST(DrawPreviews, TintsExactlyTheSurfacesOfSelectedVoxels) {
  const PictureRays rays = rays_to_north();
  const Picture before = wall();
  Picture drawn = before;
  const auto selects = [](const Vec3i64& v) { return v[0] * v[0] + v[2] * v[2] < 30 * 30; };
  draw_previews(drawn, rays, {{{{-9999, -999, -9999}, {9999, 999, 9999}}, {200, 0, 0}, selects}}, callers_thread());
  int tinted = 0;
  for (int y = 0; y < wall_pixels; ++y)
    for (int x = 0; x < wall_pixels; ++x) {
      const std::size_t pixel = std::size_t(y * wall_pixels + x);
      const kernels::CastLine line = kernels::line_of_sight({}, rays.camera, x, y);
      const Vec3i64 voxel = Vec3i64::by_axis([&](int axis) {
        return std::int64_t(std::floor(line.origin[axis] + line.direction[axis] * (double(wall_distance) + 0.5)));
      });
      const bool is_selected = before.depth[pixel] < kernels::CastRay::no_depth && selects(voxel);
      EXPECT_EQ(drawn.rgba[4 * pixel], is_selected ? (128 + 2 * 200) / 3 : 128) << x << " " << y;
      tinted += is_selected;
    }
  EXPECT_GT(tinted, 50);
  EXPECT_EQ(drawn.depth, before.depth);
}

TEST(DrawPreviews, OutlinesTheBoundsWhereNoSurfaceIsSelected) {
  Picture drawn = wall();
  const auto none = [](const Vec3i64&) { return false; };
  draw_previews(drawn, rays_to_north(), {{Box3i64::cube({-20, -40, -20}, 40), {200, 0, 0}, none}}, callers_thread());
  EXPECT_NE(drawn.rgba, wall().rgba);
  drawn = wall();
  draw_previews(drawn, rays_to_north(), {}, callers_thread());
  EXPECT_EQ(drawn.rgba, wall().rgba);
}

/// Draws the previews with a test of every pixel.
void draw_slowly(Picture& picture, const PictureRays& rays, const EditPreviews& previews) {
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (const EditPreview& preview : previews) {
        const std::size_t pixel = std::size_t(y * picture.width + x);
        const kernels::CastLine line = kernels::line_of_sight({}, rays.camera, x, y);
        const Vec3i64 voxel = Vec3i64::by_axis([&](int axis) {
          return std::int64_t(
              std::floor(line.origin[axis] + line.direction[axis] * (double(picture.depth[pixel]) + 0.5)));
        });
        if (picture.depth[pixel] == kernels::CastRay::no_depth || !preview.bounds.contains(voxel)) continue;
        for (std::size_t c = 0; preview.selects(voxel) && c < 3; ++c)
          picture.rgba[4 * pixel + c] = std::uint8_t((picture.rgba[4 * pixel + c] + 2 * preview.rgb[c]) / 3);
      }
  for (const EditPreview& preview : previews) draw_edges(picture, rays.camera, preview.bounds, preview.rgb);
}

/// Random boxes are partly outside the image, around the eye or behind it, so all types of rectangles occur.
TEST(DrawPreviews, EqualsATestOfEveryPixelForAnyBoxesAndThreads) {
  constexpr unsigned seed = 77;
  std::mt19937 random(seed);
  const auto from = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
  const auto any = [](const Vec3i64&) { return true; };
  const ThreadPool pool(3);
  int changed = 0;
  for (int round = 0; round < 200; ++round) {
    PictureRays rays = rays_to_north();
    rays.camera.eye = {from(-50, 50) / 3.0, -100 + from(-50, 50) / 3.0, from(-50, 50) / 3.0};
    rays.camera.right = {0.5 + from(0, 10) / 10.0, 0, 0};
    Picture before = wall();
    for (float& depth : before.depth)
      if (depth != kernels::CastRay::no_depth) depth = float(from(1, 150));
    EditPreviews previews;
    for (int i = from(1, 3); i > 0; --i)
      previews.push_back({Box3i64::cube({from(-120, 80), from(-160, 40), from(-120, 80)}, from(1, 90)),
                          {std::uint8_t(from(0, 255)), 0, 90},
                          any});
    Picture drawn = before, expected = before;
    draw_previews(drawn, rays, previews, pool);
    draw_slowly(expected, rays, previews);
    ASSERT_EQ(drawn.rgba, expected.rgba) << "seed " << seed << " round " << round;
    ASSERT_EQ(drawn.depth, before.depth);
    changed += drawn.rgba != before.rgba;
  }
  EXPECT_GT(changed, 50);
}

TEST(EditBrush, MakesListsInTheFormOfEdits) {
  EditBrush brush;
  brush.radius_m = 2;
  const Point<Scene> at{1, 2, 3};
  EXPECT_EQ(nlohmann::json::parse(edits_of(brush, at)),
            nlohmann::json::parse(R"({"edits":[{"type":"carve","sphere":{"position_m":[1,2,3],"radius_m":2}}]})"));
  brush.type = 1, brush.shape = 1;
  EXPECT_EQ(nlohmann::json::parse(edits_of(brush, at)),
            nlohmann::json::parse(
                R"({"edits":[{"type":"fill","box":{"min_m":[-1,0,2],"max_m":[3,4,4]},"rgb":[220,40,40]}]})"));
  brush.type = 2, brush.shape = 2;
  EXPECT_EQ(nlohmann::json::parse(edits_of(brush, at))["edits"][0]["cylinder"],
            nlohmann::json::parse(R"({"position_m":[1,2,2],"radius_m":2,"height_m":2})"));
}

}  // namespace
}  // namespace gigabake
