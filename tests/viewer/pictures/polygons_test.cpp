// Polygons among voxels: a cube in a forest, compared with its closed form and with the depth of the voxels.
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>

#include "kernels/marching/cast_line.h"
#include "tests/viewer/voxel_scene.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake {
namespace {

/// Returns trunks on a floor.
VoxelScene forest() {
  VoxelScene scene(64);
  scene.add_cell(
      [](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
        const bool is_trunk = x % 12 < 3 && y % 12 < 3 && z < 40;
        if (z > 1 && !is_trunk) return {};
        return Paint{{40, 120, 30, 255}, {}};
      },
      {0, 0, 0});
  return scene;
}

constexpr double low = 20, high = 38;  ///< the cube's extent along each axis

std::shared_ptr<const PolygonMesh> cube() {
  const auto corner = [](int i) {
    return Point<Scene>{(i & 1) != 0 ? high : low, (i & 2) != 0 ? high : low, (i & 4) != 0 ? high : low};
  };
  constexpr int sides[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};
  auto mesh = std::make_shared<PolygonMesh>();
  for (const auto& side : sides) {
    mesh->triangles.push_back({corner(side[0]), corner(side[1]), corner(side[2])});
    mesh->triangles.push_back({corner(side[0]), corner(side[2]), corner(side[3])});
  }
  mesh->colour = [](std::size_t, float, float) { return std::array<float, 4>{1, 0, 0, 1}; };
  return mesh;
}

/// Returns the distance along a ray to the cube; infinity if the ray misses it.
double distance_to_cube(const kernels::CastLine& line) {
  double enter = 0, leave = HUGE_VAL;
  for (int a = 0; a < 3; ++a) {
    const double p = (low - line.origin[a]) / line.direction[a], q = (high - line.origin[a]) / line.direction[a];
    enter = std::max(enter, std::min(p, q));
    leave = std::min(leave, std::max(p, q));
  }
  return enter <= leave ? enter : HUGE_VAL;
}

/// Returns true if a pixel differs from one of its neighbours.
bool is_at_border(const std::vector<bool>& mask, int edge, int x, int y) {
  const auto at = [&](int i, int j) { return mask[std::size_t(j) * std::size_t(edge) + std::size_t(i)]; };
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, edge - 1); ++j)
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, edge - 1); ++i)
      if (at(i, j) != at(x, y)) return true;
  return false;
}

void expect_cube_seen_from(const std::array<double, 3>& eye_m) {
  constexpr int edge = 160;
  const VoxelScene scene = forest();
  FrameRenderer::Options options;
  options.threads = 2;
  FrameRenderer renderer(scene.description(), "scene.xml", scene.pages(), options);
  View view_of{
      view(eye_m, {29, 29, 20}, edge).camera, ViewMode::albedo, {false, {0, 0, 0, 0}}, PictureLight::linear_too};
  const Picture without = renderer.render_complete(view_of).picture;
  view_of.polygons = cube();
  const Picture with = renderer.render_complete(view_of).picture;
  const kernels::CastCamera camera = make_camera(view_of.camera, scene.paged());
  std::vector<bool> expected, shown;
  std::vector<double> cube_at;
  for (int i = 0; i < edge * edge; ++i) {
    const auto pixel = std::size_t(i);
    cube_at.push_back(distance_to_cube(kernels::line_of_sight({}, camera, i % edge, i / edge)));
    expected.push_back(cube_at[pixel] < double(without.depth[pixel]));
    shown.push_back(std::fabs(double(with.depth[pixel]) - cube_at[pixel]) < 1e-3);
  }
  int hidden = 0, seen = 0, beside = 0;
  double through = 0;
  for (int i = 0; i < edge * edge; ++i) {
    const auto pixel = std::size_t(i);
    const bool is_near = is_at_border(expected, edge, i % edge, i / edge);
    if (shown[pixel] != expected[pixel]) {
      ++beside;
      EXPECT_TRUE(is_near) << "pixel " << i % edge << ", " << i / edge << ": cube at " << cube_at[pixel]
                           << ", voxels at " << without.depth[pixel] << ", shown " << with.depth[pixel];
      continue;
    }
    if (is_near) continue;
    if (expected[pixel]) {
      ++seen;
      EXPECT_GT(with.linear[4 * pixel], 0.5) << "at most half of the light is a soft border's before it; pixel " << i;
    } else if (cube_at[pixel] < HUGE_VAL) {
      ++hidden;
      const double red = double(with.linear[4 * pixel]) - double(without.linear[4 * pixel]);
      EXPECT_LT(red, 0.5) << i;
      through += std::fabs(red);
    } else {
      for (std::size_t k = 0; k < 4; ++k) ASSERT_EQ(with.linear[4 * pixel + k], without.linear[4 * pixel + k]);
    }
  }
  EXPECT_GT(hidden, 200);
  EXPECT_GT(seen, 200);
  EXPECT_LT(through / hidden, 0.01) << "of the cube through what hides it, in the mean";
  testing::Test::RecordProperty("pixels_on_the_other_side", beside);
}

TEST(Polygons, ACubeInAForestIsHiddenAndHidesToAPixel) {
  expect_cube_seen_from({-30, -42, 30});
  expect_cube_seen_from({90, -10, 24});
  expect_cube_seen_from({33, 110, 60});
}

TEST(Polygons, AreDrawnWhereTheyPassTheEyeAndNotBehindIt) {
  const VoxelScene scene = forest();
  SceneHeader header = scene.description();
  kernels::CastCamera camera = make_camera(view({0, 0, 10}, {1, 0, 10}, 33).camera, scene.paged());
  PolygonMesh wall;
  wall.colour = [](std::size_t, float, float) { return std::array<float, 4>{0, 1, 0, 1}; };
  wall.triangles = {{Point<Scene>{-100, 3, -200}, Point<Scene>{300, 3, -200}, Point<Scene>{100, 3, 400}},
                    {Point<Scene>{-5, -9, 0}, Point<Scene>{-5, 9, 0}, Point<Scene>{-5, 0, 40}},
                    {Point<Scene>{5, -9, 0}, Point<Scene>{std::nan(""), 9, 0}, Point<Scene>{5, 0, 40}}};
  const PolygonPicture picture = draw_polygons(wall, header, camera, kernels::unlit(), {}, callers_thread());
  for (int i = 0; i < 33 * 33; ++i) {
    const kernels::CastLine line = kernels::line_of_sight({}, camera, i % 33, i / 33);
    const double expected = line.direction[1] > 0 ? 3 / line.direction[1] : HUGE_VAL;
    const float distance = picture.distance[std::size_t(i)];
    if (expected < 100) {
      ASSERT_NEAR(distance, expected, 1e-4 * expected) << i;
    } else if (line.direction[1] <= 0) {
      ASSERT_EQ(distance, kernels::CastPolygons::nowhere) << i;
    }
  }
}

}  // namespace
}  // namespace gigabake
