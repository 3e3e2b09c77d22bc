#include "worker/scan/coordinate_resolution.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "glb_scene.h"
#include "worker/scan/scan_tile.h"

namespace gigabake {
namespace {

Instance scaled_by(double x, double y, double z) {
  Instance instance;
  instance.scene_from_local.m = {{{x, 0, 0, 5e6}, {0, y, 0, -7e6}, {0, 0, z, 1e9}}};
  return instance;
}

/// Returns the distance from a float to the next float of larger magnitude, computed from its exponent.
double spacing_of(float v) {
  int exponent = 0;
  std::frexp(v, &exponent);
  return std::ldexp(1.0, exponent - 24);
}

TEST(PositionSpacing, IsHalfAMetreForFloatsOnTheEarthsSurface) {
  EXPECT_EQ(coordinate_resolution_m({}, scaled_by(1, 1, 1), {6378137, 100, 0}), 0.5);
}

TEST(PositionSpacing, IsThatOfTheFloatTimesTheScaleOfItsAxisWhereverTheInstanceStands) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> magnitude(-20, 25);
  for (int i = 0; i < 1000; ++i) {
    const float x = std::exp2(magnitude(random)), y = std::exp2(magnitude(random)), z = std::exp2(magnitude(random));
    const double expected = std::max({3 * spacing_of(x), 1e-6 * spacing_of(y), 1e6 * spacing_of(z)});
    ASSERT_DOUBLE_EQ(coordinate_resolution_m({}, scaled_by(3, -1e-6, 1e6), {x, y, z}), expected)
        << x << ' ' << y << ' ' << z;
  }
}

TEST(PositionSpacing, IsTheStepOfQuantizedPositionsHoweverSmallTheyAre) {
  Primitive primitive;
  primitive.position_step = 1.0f / 32767;
  EXPECT_DOUBLE_EQ(coordinate_resolution_m(primitive, scaled_by(1000, 2000, 10), {0, 0, 0}),
                   2000 * double(1.0f / 32767));
}

TEST(PositionSpacing, OfARotatedAxisIsItsLength) {
  Instance instance;
  instance.scene_from_local.m = {{{0.6, -0.8, 0, 0}, {0.8, 0.6, 0, 0}, {0, 0, 1, 0}}};
  EXPECT_DOUBLE_EQ(coordinate_resolution_m({}, instance, {6378137, 0, 0}), 0.5);
}

TEST(ScanTile, FindsTheSpacingOfItsCoarsestVertexAndIgnoresThoseThatAreDropped) {
  const ScratchFolder folder;
  GlbMesh mesh;
  mesh.position = {3e5f, 1, 2, 3e5f + 4, 1, 2, 3e5f, 5, 2, 1e30f, 0, 0};
  mesh.index = {0, 1, 2, 1, 2, 3};
  write_glb(folder.path() / "far.glb", mesh);
  BakeParameters parameters;
  parameters.voxel_size_m = 1;
  parameters.cell_voxels = 64;
  const TileScan s = scan_tile(sources_of(folder.path(), {"far.glb"}), 0, parameters, ThreadPool(2));
  EXPECT_EQ(s.error, "");
  EXPECT_EQ(s.too_far, 1u);
  EXPECT_EQ(s.spacing_m, 1.0 / 32);
}

}  // namespace
}  // namespace gigabake
