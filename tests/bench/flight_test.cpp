// Tests the parts of `bench accuracy --flight`: the orbit, the levels of the mesh, the choice of a level, and that the
// mesh at full level is the reference.
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <set>

#include "bench/accuracy/reference_caster.h"
#include "bench/flight/flight_path.h"
#include "bench/flight/mesh_baseline.h"
#include "tests/worker/glb_scene.h"

namespace gigabake::bench {
namespace {

constexpr int edge = 32;  ///< squares along a side of the ground

BakeParameters half_metres() {
  BakeParameters lattice;
  lattice.voxel_size_m = 0.5;
  return lattice;
}

/// Returns a camera at `eye` (voxels) that looks north and down, with 90° from top to bottom.
kernels::CastCamera camera_at(const Vec3d& eye, int pixels) {
  const double s = std::numbers::sqrt2 / 2;
  kernels::CastCamera camera;
  camera.eye = eye;
  camera.forward = {0, s, -s};
  camera.right = {1, 0, 0};
  camera.up = {0, s, s};
  camera.width = camera.height = pixels;
  return camera;
}

TEST(ChooseLevel, TakesTheCoarsestWithinAPixel) {
  const MeshLevels mesh{{{-1, 99, -1}, {1, 101, 1}}, {{{}, 0}, {{}, 1}, {{}, 2}, {{}, 4}}};
  kernels::CastCamera camera = camera_at({0, 0, 0}, 0);
  // 99 voxels away, an image of n pixels shows 198 voxels: a pixel is 198 / n wide.
  for (const auto& [pixels, level] : {std::pair{199, 0}, {198, 1}, {100, 1}, {99, 2}, {50, 2}, {49, 3}, {1, 3}}) {
    camera.width = camera.height = pixels;
    EXPECT_EQ(choose_level(mesh, camera, 1), level) << pixels;
    EXPECT_LE(mesh.levels[std::size_t(level)].error, pixel_width(camera, 99)) << pixels;
  }
  camera.width = camera.height = 50;
  EXPECT_EQ(choose_level(mesh, camera, 0.5), 1) << "half a pixel";
  EXPECT_EQ(choose_level(mesh, camera, 0), 0);
}

TEST(ChooseLevel, TakesTheFirstLevelAroundTheEye) {
  const MeshLevels mesh{{{-10, -10, -10}, {10, 10, 10}}, {{{}, 0}, {{}, 1e-6}}};
  EXPECT_EQ(choose_level(mesh, camera_at({0, 0, 0}, 1), 1), 0);
  EXPECT_EQ(choose_level(mesh, camera_at({10, 10, 10}, 1), 1), 0) << "on a corner of the box";
}

TEST(ChooseLevel, TakesNoLevelBehindTheEye) {
  const MeshLevels mesh{{{-1, -1, -1}, {1, 1, 1}}, {{{}, 0}}};
  EXPECT_EQ(choose_level(mesh, camera_at({0, 1.9, 0}, 9), 1), 0) << "a corner is in front";
  EXPECT_EQ(choose_level(mesh, camera_at({0, 2.1, 0}, 9), 1), std::nullopt);
  EXPECT_EQ(choose_level(mesh, camera_at({0, 100, 0}, 9), 1), std::nullopt);
}

TEST(Orbit, HasStepsOfOneLength) {
  const FlightArea area{{10, 20, 30}, 100, 25, 0.5};
  const double length_m = orbit_length_m(area);
  EXPECT_NEAR(length_m, 2 * std::numbers::pi * 45, 5) << "between the circle and its hills";
  for (const double step_m : {0.37, 3.0, length_m / 5}) {
    const std::vector<double> angles = orbit_angles(area, step_m);
    EXPECT_EQ(angles.size(), std::size_t(std::ceil(length_m / step_m - 1e-6))) << step_m;
    for (std::size_t i = 1; i < angles.size() && step_m < 1; ++i) {
      const Point<Scene> a = *orbit_view(area, angles[i - 1], 8, 8).camera.eye_m,
                         b = *orbit_view(area, angles[i], 8, 8).camera.eye_m;
      EXPECT_NEAR(std::hypot(a.x - b.x, a.y - b.y, a.z - b.z), step_m, 0.01 * step_m) << i;
    }
  }
}

class Levels : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_mesh_levels() || !ReferenceCaster::is_built()) GTEST_SKIP() << "built without meshoptimizer or Embree";
    write_glb(folder_.path() / "ground.glb", rolling_ground(edge, 0, 0));
  }
  SceneSources sources() const { return sources_of(folder_.path(), {"ground.glb"}); }

  ScratchFolder folder_;
};

TEST_F(Levels, HaveFewerTrianglesAndLargerErrors) {
  const SourceTriangles source(sources(), half_metres(), 1);
  const MeshLevels mesh = make_mesh_levels(source, 0);
  ASSERT_GE(mesh.levels.size(), 3u);
  EXPECT_EQ(mesh.levels[0].index.size(), std::size_t(6 * edge * edge));
  EXPECT_EQ(mesh.levels[0].error, 0);
  for (std::size_t i = 1; i < mesh.levels.size(); ++i) {
    EXPECT_LT(mesh.levels[i].index.size(), mesh.levels[i - 1].index.size()) << i;
    EXPECT_GE(mesh.levels[i].error, mesh.levels[i - 1].error) << i;
    EXPECT_GT(mesh.levels[i].error, 0) << i;
  }
}

TEST_F(Levels, KeepTheVerticesOfOpenEdges) {
  const SourceTriangles source(sources(), half_metres(), 1);
  const MeshLevels mesh = make_mesh_levels(source, 0);
  const TriangleBox& box = mesh.box;
  const auto on_border = [&](const MeshLevel& level) {
    const SourceTriangles simplified = source.with_indices({{level.index.data(), level.index.size()}});
    std::set<Vec3d> found;
    for (std::size_t t = 0; t < level.index.size() / 3; ++t)
      for (const Vec3d& p : simplified.corners(0, t))
        if (p[0] == box.min[0] || p[0] == box.max[0] || p[1] == box.min[1] || p[1] == box.max[1]) found.insert(p);
    return found;
  };
  const std::set<Vec3d> border = on_border(mesh.levels.front());
  EXPECT_EQ(border.size(), std::size_t(4 * edge));
  for (const MeshLevel& level : mesh.levels) EXPECT_EQ(on_border(level), border) << level.error;
}

TEST_F(Levels, AtFullLevelAreTheReferenceItself) {
  const ReferenceCaster reference(sources(), half_metres(), 2);
  const MeshBaseline baseline(reference.triangles(), 2);
  const Vec3d middle = reference.box().centre();
  const kernels::CastCamera camera = camera_at(middle + Vec3d{0, -20, 30}, 24);
  const auto drawn = [&](const MeshChoice& choice) {
    return ReferenceCaster(reference.triangles().with_indices(choice.indices), 2).draw(camera, 4);
  };
  const MeshChoice full = baseline.choose(camera, 0), coarse = baseline.choose(camera, 10);
  EXPECT_EQ(full.triangles, baseline.source_triangles());
  EXPECT_EQ(drawn(full).rgba, reference.draw(camera, 4).rgba);
  EXPECT_LT(coarse.triangles, full.triangles);
  EXPECT_LT(coarse.bytes, full.bytes);
  EXPECT_EQ(drawn(coarse).rgba.size(), std::size_t(4 * 24 * 24));
}

TEST_F(Levels, BehindTheEyeAreNotDrawn) {
  const ReferenceCaster reference(sources(), half_metres(), 1);
  const MeshBaseline baseline(reference.triangles(), 1);
  const kernels::CastCamera camera = camera_at(reference.box().max + Vec3d{0, 100, 0}, 8);
  const MeshChoice choice = baseline.choose(camera, 1);
  EXPECT_EQ(choice.triangles, 0u);
  const LinearPicture empty = ReferenceCaster(reference.triangles().with_indices(choice.indices), 1).draw(camera, 1);
  EXPECT_EQ(empty.rgba, reference.draw(camera, 1).rgba);
}

}  // namespace
}  // namespace gigabake::bench
