#include "kernels/marching/surface_hit.h"

#include <gtest/gtest.h>

namespace gigabake::kernels {
namespace {

/// A horizontal surface below a ray that goes straight down through voxels of lod 4; samples are half a voxel apart.
struct RayDown {
  CastLine line{};
  CastRay ray;

  RayDown() {
    line.direction[2] = -1;
    ray.lod = 4;
  }

  /// Returns the ray's distance to the surface if this sample, `signed_distance` voxels above it, is the first at or
  /// below it.
  double next(double distance, float signed_distance) {
    const SurfaceBlend blend = {1, {0, 0, 127}, 254 * signed_distance};
    const double met = surface_hit_distance(blend, line, ray.lod, distance, ray);
    keep_signed_distance(blend, line, ray.lod, distance, ray);
    return met;
  }
  double next_without_sheet(double distance) {
    const double met = surface_hit_distance({}, line, ray.lod, distance, ray);
    ray.signed_distance = CastRay::no_signed_distance;
    return met;
  }
};

TEST(SheetMet, IsWhereTheHeightChangesItsSign) {
  RayDown down;
  EXPECT_EQ(down.next(100, 0.75f), met_nowhere);
  EXPECT_EQ(down.next(108, 0.25f), met_nowhere);
  EXPECT_NEAR(down.next(116, -0.25f), 112, 1e-4);
  EXPECT_EQ(down.next(124, -0.75f), met_nowhere);
}

// 2026-11-23: planes tilted by half a degree, seen straight down from a lattice plane, let all light through. This
// happened where a sample lay exactly on the surface.
TEST(SheetMet, IsOnceWhereAPointLiesOnTheSheet) {
  RayDown down;
  EXPECT_EQ(down.next(100, 0.5f), met_nowhere);
  EXPECT_EQ(down.next(108, 0), 108);
  EXPECT_EQ(down.next(116, -0.5f), met_nowhere);
  RayDown begins;
  EXPECT_EQ(begins.next(100, 0), 100);
  EXPECT_EQ(begins.next(108, -0.5f), met_nowhere);
  RayDown ends;
  EXPECT_EQ(ends.next(100, 0), 100);
  EXPECT_EQ(ends.next_without_sheet(108), met_nowhere);
}

TEST(SheetMet, IsWhereTheSheetGoesOnBeyondTheEndOfItsField) {
  RayDown leaves;
  EXPECT_EQ(leaves.next(100, 0.004f), met_nowhere);
  EXPECT_NEAR(leaves.next_without_sheet(108), 100.064, 1e-4);
  EXPECT_EQ(leaves.next_without_sheet(116), met_nowhere);
  RayDown enters;
  EXPECT_EQ(enters.next_without_sheet(100), met_nowhere);
  EXPECT_NEAR(enters.next(108, -0.25f), 104, 1e-4);
}

TEST(SheetMet, IsNowhereFartherThanPointsAreFromEachOther) {
  RayDown leaves;
  EXPECT_EQ(leaves.next(100, 0.75f), met_nowhere);
  EXPECT_EQ(leaves.next_without_sheet(108), met_nowhere);
  RayDown enters;
  EXPECT_EQ(enters.next_without_sheet(100), met_nowhere);
  EXPECT_EQ(enters.next(108, -0.75f), met_nowhere);
}

TEST(SheetMet, IsNowhereWhereTheRayRunsAlongTheSheet) {
  RayDown along;
  along.line.direction[2] = 0;
  along.line.direction[0] = 1;
  EXPECT_EQ(along.next(100, 0.25f), met_nowhere);
  EXPECT_EQ(along.next_without_sheet(108), met_nowhere);
}

}  // namespace
}  // namespace gigabake::kernels
