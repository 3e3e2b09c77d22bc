// Shadows and sky occlusion, compared with geometry.
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <utility>

#include "core/math/octahedral.h"
#include "tests/viewer/voxel_scene.h"
#include "viewer/light/sky.h"
#include "viewer/pictures/frame_renderer.h"
#include "viewer/pictures/render.h"

namespace gigabake {
namespace {

constexpr int edge = 128;  ///< edge of scenes, and of images from above, in voxels: one per pixel

Paint white(double x, double y, double z) {
  Paint paint;
  encode_octahedral(x, y, z, paint.normal.data());
  return paint;
}

/// Returns a sky of radiance 1 without sun and ground: the image shows the visible fraction of the sky.
kernels::CastLighting sky_alone() {
  kernels::CastLighting out = lighting({}, kernels::CastLightPart::sky, {});
  for (int k = 0; k < 3; ++k) {
    out.light.sky[k] = 1;
    out.light.ground[k] = 0;
  }
  return out;
}

/// Returns the light of the scene from far above, one voxel per pixel. Pixel (x, y) shows voxel column (x + shift, edge
/// - 1 - y).
std::vector<float> from_above(const VoxelScene& scene, const kernels::CastLighting& light, double shift = 0) {
  const ThreadPool policy(2);
  SceneStream::Options options;
  options.light = kernels::unlit();
  options.memory_bytes = std::uint64_t(1) << 28;
  SceneStream stream(scene.paged(), scene.pages(), options, policy);
  CameraOptions camera =
      view({edge / 2.0 + shift, edge / 2.0, 20000}, {edge / 2.0 + shift, edge / 2.0, 0}, edge).camera;
  camera.up = Point<Scene>{0, 1, 0};
  camera.fovy_deg = 2 * std::atan(edge / 2.0 / 20000) * 180 / std::numbers::pi;
  const kernels::CastCamera cast = make_camera(camera, scene.paged());
  return render(stream, cast, {false, {0, 0, 0, 0}}, PictureLight::linear_too, light).linear;
}

float at(const std::vector<float>& linear, int x, int y) {
  return linear[4 * (std::size_t(edge - 1 - y) * edge + std::size_t(x))];
}

/// Returns the visible fraction of the light for each column x of ground next to a wall along y. Each value is the mean
/// over a block of pixels, because each pixel of a block samples a different part of the sun.
std::vector<double> along_x(const VoxelScene& scene, const kernels::CastLighting& light) {
  std::vector<double> mean(edge - kernels::sun_block);
  for (int shift = 0; shift < kernels::sun_block; ++shift) {
    const std::vector<float> seen = from_above(scene, light, shift);
    for (std::size_t x = 0; x < mean.size(); ++x)
      for (int y = 64; y < 64 + kernels::sun_block; ++y)
        if (int(x) >= shift) mean[x] += at(seen, int(x) - shift, y) / (kernels::sun_block * kernels::sun_block);
  }
  return mean;
}

/// Returns the first position after `from` at which the value exceeds `share`, interpolated between columns. The middle
/// of column i is i + ½.
double rises_above(const std::vector<double>& seen, std::size_t from, double share) {
  for (std::size_t x = from + 1; x < seen.size(); ++x)
    if (seen[x] > share) return double(x) - 0.5 + (share - seen[x - 1]) / (seen[x] - seen[x - 1]);
  return HUGE_VAL;
}

/// Returns ground at z = 1, and a wall of the given height with its east side at x = 32.
VoxelScene wall(int height) {
  VoxelScene scene(edge);
  scene.add_cell(
      [=](std::int64_t x, std::int64_t, std::int64_t z) -> std::optional<Paint> {
        const bool is_wall = x >= 29 && x < 32 && z <= height;
        if (z == 0) return white(0, 0, 1);
        if (!is_wall) return {};
        return z == height ? white(0, 0, 1) : white(x == 29 ? -1 : 1, 0, 0);
      },
      {0, 0, 0});
  return scene;
}

TEST(Shadows, OfAWallHasItsLengthAndItsBordersWidthToAVoxel) {
  const VoxelScene scene = wall(32);
  for (const auto& [elevation, radius_deg] :
       {std::pair(40.0, sun_radius_deg), std::pair(55.0, sun_radius_deg), std::pair(40.0, 3.0)}) {
    const std::vector<double> seen =
        along_x(scene, lighting({270, elevation}, kernels::CastLightPart::shadow, {}, radius_deg));
    const double sine = std::sin(elevation * std::numbers::pi / 180);
    const double slope = std::tan(elevation * std::numbers::pi / 180);
    // The visible fraction of the sun's disc rises from 10 to 90 % while an edge moves by 1.374 radii. A voxel's border
    // adds a blur of 1.2 voxels.
    const double disc = 1.374 * 32 * std::tan(radius_deg * std::numbers::pi / 180) / (sine * sine);
    const double middle = rises_above(seen, 36, 0.5);
    const double width = rises_above(seen, 36, 0.9) - rises_above(seen, 36, 0.1);
    EXPECT_NEAR(middle, 32 + 32 / slope, 1) << elevation << "°, sun of " << radius_deg;
    EXPECT_NEAR(width, std::hypot(disc, 1.2), 1) << elevation << "°, sun of " << radius_deg;
    EXPECT_LT(seen[40], 0.01);
    EXPECT_GT(seen[20], 0.99) << "before the wall";
  }
}

TEST(Sky, IsSeenWholeFromAnOpenPlaneAndHalfAtTheFootOfAWall) {
  VoxelScene open(edge);
  open.add_cell(
      [](std::int64_t, std::int64_t, std::int64_t z) -> std::optional<Paint> {
        if (z != 20) return {};
        return white(0, 0, 1);
      },
      {0, 0, 0});
  const std::vector<float> plane = from_above(open, sky_alone());
  for (int i = 8; i < edge - 8; i += 7) EXPECT_NEAR(at(plane, i, edge - i), 1, 1e-4) << i;  // an alpha of 65535 / 65536

  const std::vector<float> foot = from_above(wall(100), sky_alone());
  for (const int x : {35, 40, 50}) {
    const double off = x + 0.5 - 32;
    EXPECT_NEAR(at(foot, x, 64), 0.5 + 0.5 * off / std::hypot(off, 100), 0.06)
        << x;  // closed form of an infinite wall; this wall is 128 long
  }
}

TEST(Sky, OfAPitIsItsClosedForm) {
  for (const int depth : {12, 24, 48}) {
    constexpr double radius = 24;
    VoxelScene pit(edge);
    pit.add_cell(
        [=](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
          const double u = double(x) + 0.5 - 64, v = double(y) + 0.5 - 64, off = std::hypot(u, v);
          if (off >= radius && z == depth) return white(0, 0, 1);
          if (off >= radius && off < radius + 2 && z < depth) return white(-u, -v, 0);
          if (off < radius && z == 0) return white(0, 0, 1);
          return {};
        },
        {0, 0, 0});
    const std::vector<float> seen = from_above(pit, sky_alone());
    EXPECT_NEAR(at(seen, 64, 64), radius * radius / (radius * radius + depth * depth), 0.06) << depth;
  }
}

/// Returns posts and roofs on ground, in several cells; roofs hide the surfaces below them from above.
VoxelScene posts() {
  VoxelScene scene(32);
  scene.add_cells(
      [](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
        if (z == 2 + (x + y) / 40) return white(0, 0, 1);
        if (x % 16 < 3 && y % 16 < 3 && z > 2 && z < 24) return white(x % 16 == 0 ? -1 : 1, 0, 0);
        if (x % 32 < 14 && y % 32 < 14 && z == 24) return white(0, 0, 1);
        return {};
      },
      {0, 0, 0}, 64);
  return scene;
}

View shadowed_view() {
  View out{view({-60, -70, 60}, {32, 32, 10}, 150).camera, ViewMode::lit, {}, PictureLight::linear_too};
  out.shadows = Shadows::on;
  return out;
}

TEST(Shadows, ArePicturesOfTheSameBytesInTilesAsAWholeAndWithAnyMemory) {
  const VoxelScene scene = posts();
  FrameRenderer::Options options;
  options.threads = 2;
  FrameRenderer renderer(scene.description(), "scene.xml", scene.pages(), options);
  const Picture tiles = renderer.render_complete(shadowed_view()).picture;
  Frame whole;
  for (int i = 0; i < 1000 && !whole.stats.complete; ++i) whole = renderer.draw(shadowed_view(), 1);
  EXPECT_EQ(whole.picture.linear, tiles.linear);
  options.threads = 1;
  options.memory_bytes = std::uint64_t(3) << 20;
  FrameRenderer small(scene.description(), "scene.xml", scene.pages(), options);
  EXPECT_EQ(small.render_complete(shadowed_view()).picture.linear, tiles.linear);
}

TEST(Shadows, LeaveTheLightAsItIsWhereNothingStandsInIt) {
  VoxelScene open(edge);
  open.add_cell(
      [](std::int64_t x, std::int64_t, std::int64_t z) -> std::optional<Paint> {
        if (z != x / 8) return {};
        return white(-1, 0, 8);
      },
      {0, 0, 0});
  FrameRenderer::Options options;
  options.threads = 2;
  FrameRenderer renderer(open.description(), "scene.xml", open.pages(), options);
  View with{
      view({64, -90, 160}, {64, 64, 8}, 96).camera, ViewMode::lit, {false, {0, 0, 0, 0}}, PictureLight::linear_too};
  const std::vector<float> plain = renderer.render_complete(with).picture.linear;
  with.shadows = Shadows::on;
  const std::vector<float> lit = renderer.render_complete(with).picture.linear;
  double sum = 0, plain_sum = 0;
  for (std::size_t i = 0; i < lit.size(); ++i) {
    sum += lit[i];
    plain_sum += plain[i];
  }
  EXPECT_NEAR(sum / plain_sum, 1, 0.02);
}

}  // namespace
}  // namespace gigabake
