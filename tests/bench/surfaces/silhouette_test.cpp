// Compares exact silhouettes with closed forms and with rays to the triangles that are written for the scenes.
#include "bench/hard/surfaces/silhouette.h"

#include <gtest/gtest.h>

#include "bench/accuracy/accuracy_views.h"
#include "bench/accuracy/leaks/sheet_mesh.h"
#include "bench/hard/surfaces/baked_surface.h"
#include "bench/hard/surfaces/surface_bounds.h"
#include "tests/worker/glb_scene.h"

namespace gigabake::bench {
namespace {

ConvexBody box(const Vec3d& low, const Vec3d& high) {
  ConvexBody body;
  for (const double x : {low[0], high[0]})
    for (const double y : {low[1], high[1]})
      for (const double z : {low[2], high[2]}) body.corners.push_back({x, y, z});
  return body;
}

Pinhole from_above(double voxels_per_pixel) {
  return Pinhole(narrow_camera({0, 0, 0}, {0, 0, 1}, voxels_per_pixel, 60, 40));
}

TEST(Silhouette, OfSquaresIsTheirUnion) {
  const ConvexBody left = box({-10, -5, -1e-9}, {2, 5, 0}), right = box({-3, -5, -1e-9}, {8, 5, 0});
  EXPECT_NEAR(silhouette_area({left}, from_above(1), 16), 120, 1e-3);
  EXPECT_NEAR(silhouette_area({left, left, right}, from_above(1), 16), 180, 1e-3);
  EXPECT_NEAR(silhouette_area({left, right}, from_above(2), 16), 45, 1e-3);
}

TEST(Silhouette, IsCutAtTheImagesBorder) {
  EXPECT_NEAR(silhouette_area({box({-100, -100, -1e-9}, {100, 100, 0})}, from_above(1), 8), 60 * 40, 1e-6);
  EXPECT_NEAR(silhouette_area({box({-100, -100, -1e-9}, {0, 0, 0})}, from_above(1), 8), 30 * 20, 1e-6);
  EXPECT_EQ(silhouette_area({box({50, 50, -1}, {60, 60, 0})}, from_above(1), 8), 0);
}

TEST(Silhouette, PixelsAreCoveredAtTheirCentres) {
  const AlphaPicture picture = silhouettes({box({-2.4, -1.4, -1e-9}, {2.6, 1.6, 0})}, from_above(1));
  double covered = 0;
  for (const double alpha : picture.alpha) covered += alpha;
  EXPECT_EQ(covered, 5 * 3);
  EXPECT_EQ(picture.alpha[18 * 60 + 28], 1) << "y points up, x to the right";
}

TEST(Silhouette, CameraSeesPointsWhereRaysPass) {
  for (const double elevation_deg : {90., 35., 10.}) {
    const CameraOptions options = narrow_camera({5, 6, 7}, forward_at(elevation_deg) * -1.0, 2.5, 60, 40);
    const kernels::CastCamera camera = reference_camera(options, BakeParameters{1});
    const kernels::CastLine line = kernels::line_of_sight(kernels::CastScene(), camera, 13, 29);
    const Vec3d seen = Vec3d::from(line.origin) + Vec3d::from(line.direction) * 1234.5;
    EXPECT_NEAR(Pinhole(options).pixel_of(seen)[0], 13.5, 1e-3) << elevation_deg;
    EXPECT_NEAR(Pinhole(options).pixel_of(seen)[1], 29.5, 1e-3) << elevation_deg;
  }
}

TEST(SurfaceBounds, AreTheGoalOrWhatWasReached) {
  const HardRange goal{0.9, 1.1};
  EXPECT_TRUE(bounded("any", "thing", "", 1.1, goal).holds());
  EXPECT_FALSE(bounded("any", "thing", "", 1.2, goal).holds());
  EXPECT_FALSE(bounded("any", "thing", "", 0.8, goal).holds());
}

class SurfaceScenes : public testing::Test {
 protected:
  void SetUp() override {
    if (!ReferenceCaster::is_built()) GTEST_SKIP() << "built without Embree";
  }

  double traced_alpha(const SurfaceScene& scene, const CameraOptions& camera, int samples) {
    const BenchScene bench = write_glb_scene(scene.model, folder_.path() / scene.name, 2);
    const ReferenceCaster caster(open_sources(bench.source, bench.source_options), bench.parameters, 2);
    const LinearPicture picture = caster.draw(reference_camera(camera, bench.parameters), samples);
    double sum = 0;
    for (std::size_t i = 0; i < picture.pixels(); ++i) sum += double(picture.alpha(i));
    return sum;
  }

  ScratchFolder folder_;
};

TEST_F(SurfaceScenes, ShowTheAreaOfTheirSilhouettes) {
  for (const SurfaceScene& scene :
       {town_scene(), thin_wires_scene(1), leaves_scene(LeafShape::sheet, 1), leaves_scene(LeafShape::solid, 1)})
    for (const double elevation_deg : {90., 35., 10.}) {
      const CameraOptions camera =
          narrow_camera(scene.bodies[scene.bodies.size() / 2].corners[0], forward_at(elevation_deg) * -1.0, 4, 60, 50);
      const double area = silhouette_area(scene.bodies, Pinhole(camera), 64);
      EXPECT_GT(area, 10) << scene.name;
      EXPECT_NEAR(traced_alpha(scene, camera, 256) / area, 1, 0.02) << scene.name << " from " << elevation_deg;
    }
}

TEST_F(SurfaceScenes, HousesAreClosed) {
  for (const double thickness : {0., 0.3, 2.}) {
    const HouseScene house = closed_house_scene(thickness, 17.9);
    for (const Vec3d& direction : {Vec3d{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
      CameraOptions camera = narrow_camera(house.inside, direction * -1.0, 1e-3, 32, 32);
      camera.fovy_deg = 90;
      EXPECT_NEAR(traced_alpha(house, camera, 16), 32 * 32, 1e-3) << house.name;
    }
  }
}

}  // namespace
}  // namespace gigabake::bench
