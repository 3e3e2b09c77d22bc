// Checks that the views of `bench accuracy` aim at places that are distributed over the area of the surface.
#include <algorithm>
#include <gtest/gtest.h>
#include <set>

#include "bench/accuracy/accuracy_views.h"
#include "tests/worker/glb_scene.h"

namespace gigabake::bench {
namespace {

/// Returns a horizontal square whose lowest corner is `east_m` east of the origin.
GlbMesh square_at(double east_m, double width_m) {
  const auto low = float(east_m), high = float(east_m + width_m), width = float(width_m);
  GlbMesh mesh;
  mesh.position = {low, 0, 0, high, 0, 0, high, 0, -width, low, 0, -width};
  mesh.index = {0, 1, 2, 0, 2, 3};
  return mesh;
}

/// 2026-11-24: all views aimed at the centre of the bounding box, which may be far from any surface.
TEST(VisiblePlaces, AreDistinctAndDistributedOverTheArea) {
  constexpr std::size_t count = 40;
  const ScratchFolder folder;
  write_glb(folder.path() / "large.glb", square_at(0, 30));
  write_glb(folder.path() / "small.glb", square_at(100, 10));
  BakeParameters lattice;
  lattice.voxel_size_m = 1;
  const SourceTriangles source(sources_of(folder.path(), {"large.glb", "small.glb"}), lattice, 2);
  const std::vector<Vec3d> places = visible_places(source, count);
  ASSERT_EQ(places.size(), count);
  EXPECT_EQ(std::set(places.begin(), places.end()).size(), count);
  const TriangleBox& box = source.box();
  std::size_t in_small = 0;
  double west = box.max[0], east = box.min[0];
  for (const auto& place : places) {
    const double from_west = place[0] - box.min[0];
    EXPECT_TRUE((from_west >= 0 && from_west <= 30) || (from_west >= 100 && from_west <= 110)) << from_west;
    in_small += from_west > 65;
    if (from_west > 65) continue;
    west = std::min(west, place[0]);
    east = std::max(east, place[0]);
  }
  EXPECT_GE(in_small, 1u) << "a tenth of the area";
  EXPECT_LE(in_small, 12u);
  EXPECT_GT(east - west, 20) << "of the 30 voxels of the large square";
}

}  // namespace
}  // namespace gigabake::bench
