#include "viewer/live/cell_boxes.h"

#include <gtest/gtest.h>

#include "kernels/marching/cast_ray.h"

namespace gigabake {
namespace {

constexpr int image_edge = 64;

/// Returns a camera at (0, -100, 0) that looks north; the image spans 45° up, down and to each side.
kernels::CastCamera camera_to_north() {
  kernels::CastCamera camera;
  camera.eye = {0, -100, 0};
  camera.forward = {0, 1, 0};
  camera.right = {1, 0, 0};
  camera.up = {0, 0, 1};
  camera.width = camera.height = image_edge;
  camera.lod1_depth = 1;
  return camera;
}

Picture grey_picture(float depth) {
  Picture picture;
  picture.width = picture.height = image_edge;
  picture.rgba.assign(std::size_t(4) * image_edge * image_edge, 128);
  picture.depth.assign(std::size_t(image_edge) * image_edge, depth);
  return picture;
}

/// Returns the number of pixels that differ between the images.
int changed_pixels(const Picture& a, const Picture& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4) count += !std::equal(&a.rgba[i], &a.rgba[i] + 4, &b.rgba[i]);
  return count;
}

CellBox box_at(std::int64_t y, CellState state) { return {Box3i64::cube({-32, y, -32}, 64), state}; }

Picture with_boxes(const Picture& picture, const std::vector<CellBox>& boxes) {
  Picture drawn = picture;
  draw_boxes(drawn, camera_to_north(), boxes);
  return drawn;
}

TEST(CellBoxes, DrawsOnlyCellsThatAreNotDone) {
  const Picture sky = grey_picture(kernels::CastRay::no_depth);
  EXPECT_EQ(changed_pixels(sky, with_boxes(sky, {box_at(0, CellState::done)})), 0);
  const int waiting = changed_pixels(sky, with_boxes(sky, {box_at(0, CellState::waiting)}));
  const int failed = changed_pixels(sky, with_boxes(sky, {box_at(0, CellState::failed)}));
  EXPECT_GT(waiting, 100);
  EXPECT_LT(waiting, 400);
  EXPECT_GT(failed, waiting) << "it has diagonals";
  EXPECT_EQ(with_boxes(sky, {box_at(0, CellState::waiting)}).depth, sky.depth);
}

TEST(CellBoxes, EdgesLieWhereRaysMeetThem) {
  const Picture sky = grey_picture(kernels::CastRay::no_depth);
  const Picture drawn = with_boxes(sky, {box_at(0, CellState::baking)});
  const auto is_drawn = [&](int x, int y) {
    return changed_pixels(sky, drawn) > 0 && drawn.rgba[std::size_t(4) * std::size_t(y * image_edge + x)] != 128;
  };
  // The near face spans 32 of 100 to each side of the middle, which is 10.24 of 32 pixels.
  EXPECT_TRUE(is_drawn(32 - 11, 32));
  EXPECT_TRUE(is_drawn(32 + 10, 32));
  EXPECT_TRUE(is_drawn(32, 32 - 11));
  EXPECT_FALSE(is_drawn(32, 32));
  EXPECT_FALSE(is_drawn(32 - 14, 32));
}

TEST(CellBoxes, EdgesBehindSurfacesAreFaint) {
  const std::vector<CellBox> boxes{box_at(0, CellState::failed)};
  const Picture before = with_boxes(grey_picture(1000), boxes), behind = with_boxes(grey_picture(10), boxes);
  const std::size_t at = std::size_t(4) * (32 * image_edge + 32 - 11);
  EXPECT_EQ(before.rgba[at], 255);
  EXPECT_LT(behind.rgba[at], 170);
  EXPECT_GT(behind.rgba[at], 128);
}

TEST(CellBoxes, BoxesAroundAndBehindTheEyeAreClipped) {
  const Picture sky = grey_picture(kernels::CastRay::no_depth);
  EXPECT_EQ(changed_pixels(sky, with_boxes(sky, {box_at(-300, CellState::failed)})), 0);
  const CellBox around{Box3i64::cube({-500, -600, -500}, 1000), CellState::failed};
  EXPECT_GT(changed_pixels(sky, with_boxes(sky, {around})), 0);
}

TEST(CellBoxes, AClickFindsTheFirstOpenCellBeforeTheSurface) {
  const std::vector<CellBox> boxes{box_at(200, CellState::waiting), box_at(0, CellState::failed),
                                   box_at(100, CellState::done)};
  const auto picked = [&](float depth, double right = 0.5) {
    return picked_cell(grey_picture(depth), camera_to_north(), boxes, right, 0.5);
  };
  EXPECT_EQ(picked(1000), 1u);
  EXPECT_EQ(picked(50), std::nullopt) << "the surface is before all cells";
  EXPECT_EQ(picked(1000, 0.1), std::nullopt);
  EXPECT_EQ(picked_cell(grey_picture(220), camera_to_north(), std::vector<CellBox>{boxes[2]}, 0.5, 0.5), 0u);
  EXPECT_EQ(picked_cell(grey_picture(1000), camera_to_north(), std::vector<CellBox>{boxes[2]}, 0.5, 0.5), std::nullopt);
}

TEST(CellBoxes, TheTextOfACellNamesItsFirstTilesAndItsError) {
  CellFacts facts;
  facts.name = "c_1_2_0";
  facts.state = CellState::failed;
  facts.triangles = 120;
  facts.cost = 0.03;
  facts.tiles = {"a.glb"};
  facts.error = "disk full";
  EXPECT_EQ(cell_text(facts), "c_1_2_0: failed, 120 triangles, 3.0 % of the cost, 1 tile: a.glb; disk full");
  facts.tiles.assign(9, "b.glb");
  facts.error.clear();
  EXPECT_TRUE(cell_text(facts).ends_with("9 tiles: b.glb, b.glb, b.glb, b.glb, b.glb, b.glb, b.glb, b.glb, …"));
}

}  // namespace
}  // namespace gigabake
