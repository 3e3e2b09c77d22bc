#include "viewer/pictures/picture.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "tests/viewer/voxel_scene.h"

namespace gigabake {
namespace {

std::uint8_t alpha_at(const Picture& p, int x, int y) { return p.rgba[std::size_t(4 * (y * p.width + x) + 3)]; }

using Vector = std::array<double, 3>;

Vector unit(Vector v) {
  const double length = std::hypot(v[0], v[1], v[2]);
  return {v[0] / length, v[1] / length, v[2] / length};
}

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vector of(const std::optional<Point<Scene>>& p) { return {p->x, p->y, p->z}; }

/// Returns the view direction of a pixel's middle, from the definition of a pinhole camera.
Vector direction(const CameraOptions& c, int x, int y) {
  const Vector eye = of(c.eye_m), target = of(c.target_m);
  const Vector forward = unit({target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]});
  const Vector right = unit(cross(forward, {0, 0, 1})), up = cross(right, forward);
  const double pixel = 2 * std::tan(c.fovy_deg * std::numbers::pi / 360) / c.height;
  const double sx = (x + 0.5 - 0.5 * c.width) * pixel, sy = (0.5 * c.height - y - 0.5) * pixel;
  return unit({forward[0] + right[0] * sx + up[0] * sy, forward[1] + right[1] * sx + up[1] * sy,
               forward[2] + right[2] * sx + up[2] * sy});
}

struct Ball {
  Vector centre;
  double radius;

  double distance_to(double x, double y, double z) const {
    return std::hypot(x - centre[0], y - centre[1], z - centre[2]);
  }
  /// Returns the min. distance of a ray from the centre.
  double distance_to_ray(const Vector& eye, const Vector& d) const {
    const Vector to{centre[0] - eye[0], centre[1] - eye[1], centre[2] - eye[2]};
    return std::sqrt(std::max(0.0, dot(to, to) - dot(to, d) * dot(to, d)));
  }
  Painter solid() const {
    return [*this](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
      if (distance_to(double(x) + 0.5, double(y) + 0.5, double(z) + 0.5) > radius) return {};
      return Paint{{200, std::uint8_t(x * 4), std::uint8_t(z * 4), 255}, {}};
    };
  }
  /// Paints every voxel that the sphere intersects, like a bake of its surface.
  Painter shell() const {
    return [*this](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
      double nearest = 0, max_distance = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const double low = double(std::array{x, y, z}[a]) - centre[a];
        const double near = std::max({low, -low - 1, 0.0}), far = std::max(std::fabs(low), std::fabs(low + 1));
        nearest += near * near;
        max_distance += far * far;
      }
      if (nearest > radius * radius || max_distance < radius * radius) return {};
      return Paint{{90, 160, 40, 255}, {}};
    };
  }
};

constexpr Ball ball{{31.3, 32.1, 30.7}, 26};

/// Expects alpha ≥ `minimum` where the ray is at least half a voxel inside the ball. Expects the background where the
/// ray is 1.8 voxels outside. A voxel is `voxel_m` wide.
void expect_silhouette(const Picture& p, const CameraOptions& c, const Ball& b, double voxel_m, int minimum = 255) {
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      const double distance = b.distance_to_ray(of(c.eye_m), direction(c, x, y));
      if (distance < b.radius - 0.5 * voxel_m) {
        ASSERT_GE(alpha_at(p, x, y), minimum) << x << "," << y << " at " << distance << " m";
      } else if (distance > b.radius + 1.8 * voxel_m) {
        ASSERT_EQ(alpha_at(p, x, y), 0) << x << "," << y << " at " << distance << " m";
      }
    }
}

TEST(Picture, ShowsTheSilhouetteOfASolidBall) {
  VoxelScene scene(64);
  scene.add_cell(ball.solid(), {0, 0, 0});
  const PictureOptions options = view({150, -60, 90}, {31, 32, 30});
  expect_silhouette(take(scene, options), options.camera, ball, 1);
}

TEST(Picture, HasNoCrackInAClosedSurfaceOnAnyLevel) {
  VoxelScene scene(32);
  scene.add_cells(ball.shell(), {0, 0, 0}, 64);
  for (const double error : {0.5, 1.0, 2.0, 4.0, 8.0})
    for (const Vector& eye : {Vector{150, -60, 90}, Vector{32.3, 33.1, 250}, Vector{-120, -110, -130}}) {
      PictureOptions options = view(eye, {31, 32, 30}, 120);
      options.camera.pixel_error = error;
      SCOPED_TRACE(testing::Message() << "pixel error " << error << ", eye " << eye[0]);
      // Voxel size of the level at which a ball at this distance is rendered.
      const double pixel_m = 2 * std::tan(20 * std::numbers::pi / 180) / 120 * 220;
      const double voxel_m = std::exp2(std::floor(std::log2(pixel_m) + 1)) * std::max(1.0, error);
      expect_silhouette(take(scene, options), options.camera, ball, std::min(voxel_m, 8.0), error > 1 ? 250 : 255);
    }
}

TEST(Picture, LetsExactlyTheUncoveredShareThroughALayerWhereverItLies) {
  for (const int coverage : {255, 254, 230, 128, 40, 1})
    for (const double height : {1000.0, 1000.2, 1000.37, 1000.5}) {
      VoxelScene scene(16);
      scene.add_cell(
          [&](std::int64_t, std::int64_t, std::int64_t z) -> std::optional<Paint> {
            if (z != 7) return {};
            return Paint{{255, 0, 0, std::uint8_t(coverage)}, {}};
          },
          {0, 0, 0});
      PictureOptions options = view({8.1, 7.9, height}, {8.1, 7.9, 0}, 3);
      options.camera.fovy_deg = 0.01;
      EXPECT_NEAR(alpha_at(take(scene, options), 1, 1), coverage, 1) << "from a height of " << height;
    }
}

TEST(Picture, ShowsACheckerOfVoxelsWhereTheyAre) {
  VoxelScene scene(16);
  scene.add_cell(
      [](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
        if (z != 3) return {};
        const bool white = ((x + y) & 1) == 0;
        return white ? Paint{{255, 255, 255, 255}, {}} : Paint{{0, 0, 0, 255}, {}};
      },
      {0, 0, 0});
  PictureOptions options = view({8, 8, 3000}, {8, 8, 0}, 160);  // ten pixels per voxel, north is up
  options.camera.fovy_deg = 2 * std::atan(8.0 / 2996.5) * 180 / std::numbers::pi;
  const Picture picture = take(scene, options);
  for (int y = 1; y < 15; ++y)
    for (int x = 1; x < 15; ++x) {
      const std::size_t pixel = std::size_t(4 * ((10 * y + 5) * 160 + 10 * x + 5));
      const bool white = ((x + (15 - y)) & 1) == 0;
      EXPECT_NEAR(picture.rgba[pixel], white ? 255 : 0, white ? 16 : 90) << x << "," << y;
    }
}

TEST(Picture, CoversAPlaneUpToItsHorizonWithoutAGap) {
  const Painter plane = [](std::int64_t x, std::int64_t, std::int64_t z) -> std::optional<Paint> {
    if (z != 40 + x / 9) return {};
    return Paint{};
  };
  VoxelScene scene(32);
  scene.add_cells(plane, {0, 0, 0}, 128);
  PictureOptions options = view({-8, 64, 60}, {64, 64, 46}, 128);
  options.camera.fovy_deg = 30;
  const Picture picture = take(scene, options);
  for (int x = 20; x < 108; ++x) {
    int first = 0;
    while (first < 128 && alpha_at(picture, x, first) < 255) ++first;
    EXPECT_LT(first, 90);
    for (int y = first; y < 100; ++y) ASSERT_EQ(alpha_at(picture, x, y), 255) << x << "," << y;
  }
}

/// Paints voxels of random colour and coverage; half of the voxels exist.
Painter noise() {
  return [](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
    std::uint64_t h = std::uint64_t((x * 73856093) ^ (y * 19349663) ^ (z * 83492791)) * 0x9e3779b97f4a7c15ull;
    h ^= h >> 29;
    if (ball.distance_to(double(x), double(y), double(z)) > 26 || (h & 1) != 0) return {};
    return Paint{{std::uint8_t(h >> 8), std::uint8_t(h >> 16), std::uint8_t(h >> 24), std::uint8_t((h >> 32 & 63) + 1)},
                 {std::int8_t(h >> 40 & 63), std::int8_t(h >> 48 & 63)}};
  };
}

TEST(Picture, IsTheSameFromOneCellAndFromEight) {
  VoxelScene one(64), eight(32);
  one.add_cell(noise(), {0, 0, 0});
  eight.add_cells(noise(), {0, 0, 0}, 64);
  for (const Vector& eye : {Vector{100, -20, 70}, Vector{31.5, 31.5, 31.5}, Vector{32, 32, 120}}) {
    PictureOptions options = view(eye, {30, 31, 29.5});
    options.light = afternoon_light();
    EXPECT_EQ(take(one, options).rgba, take(eight, options).rgba);
  }
}

TEST(Picture, IsTheSameWhereNeighbouringCellsAreEmptyAndAbsent) {
  const Painter corner = [](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
    if (x < 22 || x > 31 || y < 20 || y > 31 || z < 25 || z > 31) return {};
    return noise()(x, y, z);
  };
  VoxelScene one(64), parts(32);
  one.add_cell(corner, {0, 0, 0});
  parts.add_cells(corner, {0, 0, 0}, 64);
  ASSERT_EQ(parts.description().cells.size(), 1u);
  for (const Vector& eye : {Vector{80, 90, 70}, Vector{40, 20, 35}, Vector{28, 27, 90}})
    EXPECT_EQ(take(one, view(eye, {28, 27, 29})).rgba, take(parts, view(eye, {28, 27, 29})).rgba);
}

TEST(Picture, ShowsConstantNodesAsTheBricksTheyStandFor) {
  const Painter blocks = [](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
    const bool solid = x < 32 && y < 32 && z < 32;                    // a leaf-constant branch
    const bool mist = x >= 32 && y < 32 && z < 32;                    // constant nodes of different coverages
    const bool box = x >= 40 && x < 48 && y >= 8 && y < 16 && z < 8;  // a leaf-constant brick
    const bool grain = (x & y & z & 4) != 0 && x >= 32;               // bricks that are not constant
    if (solid) return Paint{{250, 120, 30, 255}, {20, 30}};
    if (box) return Paint{{20, 120, 230, 20}, {}};
    if (mist) return Paint{{180, 190, 200, 9}, {}};
    if (grain) return Paint{{std::uint8_t(x), 90, 40, 60}, {}};
    return {};
  };
  VoxelScene pruned(64), bricks(64);
  pruned.add_cell(blocks, {0, 0, 0});
  bricks.add_cell(blocks, {0, 0, 0}, VoxelScene::Nodes::all_bricks);
  const std::vector<NodeKind>& kinds = pruned.shards()[0].nodes.kind;
  ASSERT_GT(std::count(kinds.begin(), kinds.end(), NodeKind::leaf_constant), 0);
  ASSERT_GT(std::count(kinds.begin(), kinds.end(), NodeKind::constant), 0);
  for (const double error : {1.0, 2.0, 4.0}) {
    PictureOptions options = view({-60, -50, 70}, {32, 32, 20});
    options.camera.pixel_error = error;
    EXPECT_EQ(take(pruned, options).rgba, take(bricks, options).rgba) << "pixel error " << error;
  }
}

TEST(Picture, IsTheSameForAnyNumberOfThreadsAndAnyMemory) {
  VoxelScene scene(16);
  scene.add_cells(noise(), {0, 0, 0}, 64);
  PictureOptions options = view({100, -20, 70}, {30, 31, 29.5}, 80);
  options.light = afternoon_light();
  const Picture expected = take(scene, options);
  for (const int threads : {1, 3}) {
    options.threads = threads;
    for (const std::uint64_t memory : {std::uint64_t(300000), std::uint64_t(2000000), std::uint64_t(1) << 30}) {
      options.memory_bytes = memory;
      EXPECT_EQ(take(scene, options).rgba, expected.rgba) << threads << " threads, " << memory << " bytes";
    }
  }
}

TEST(Picture, HasNoGapBetweenColumnsWhoseCoarseLevelsAreNotAligned) {
  const Painter slope = [](std::int64_t x, std::int64_t, std::int64_t z) -> std::optional<Paint> {
    if (z > 20 + x / 4) return {};
    return Paint{};
  };
  VoxelScene scene(256);
  for (const std::int64_t x : {0, 256}) scene.add_cell(slope, {x, 0, x == 0 ? -88 : 40});
  PictureOptions options = view({255, 128, 8000}, {255, 128, 0}, 64);
  options.camera.fovy_deg = 1.5;
  for (const double error : {0.25, 4.0, 7.0}) {
    options.camera.pixel_error = error;
    const Picture picture = take(scene, options);
    for (int y = 4; y < 60; ++y)
      for (int x = 4; x < 60; ++x) ASSERT_GT(alpha_at(picture, x, y), 250) << x << "," << y << " pixel error " << error;
  }
}

TEST(Picture, IsOpaqueFromInsideOfSomethingSolid) {
  VoxelScene scene(64);
  scene.add_cell(ball.solid(), {0, 0, 0});
  const Picture picture = take(scene, view({31, 32, 30}, {60, 32, 30}, 16));
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) EXPECT_EQ(alpha_at(picture, x, y), 255);
}

TEST(Picture, ShowsTheBackgroundAloneWhenLookingAway) {
  VoxelScene scene(64);
  scene.add_cell(ball.solid(), {0, 0, 0});
  PictureOptions options = view({150, 32, 30}, {300, 32, 30}, 16);
  options.background = {false, {10, 200, 30, 77}};
  const Picture picture = take(scene, options);
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    EXPECT_EQ(picture.rgba[i], 10);
    EXPECT_EQ(picture.rgba[i + 1], 200);
    EXPECT_EQ(picture.rgba[i + 3], 77);
  }
}

TEST(Picture, LightsWhatFacesTheSunMoreThanWhatDoesNot) {
  const auto brightness = [](std::array<std::int8_t, 2> normal) {
    VoxelScene scene(8);
    scene.add_cell(
        [&](std::int64_t, std::int64_t, std::int64_t) {
          return std::optional<Paint>(Paint{{128, 128, 128, 255}, normal});
        },
        {0, 0, 0});
    PictureOptions options = view({4, 4, 40}, {4, 4, 4}, 3);
    options.light = afternoon_light();
    return take(scene, options).rgba[4 * 4];
  };
  const std::array<std::int8_t, 2> up{0, 0}, south_west{-42, -42}, north_east{42, 42};
  EXPECT_GT(brightness(south_west), brightness(up));
  EXPECT_GT(brightness(up), brightness(north_east));
  EXPECT_NEAR(brightness(up), 128, 12);
}

}  // namespace
}  // namespace gigabake
