/// Planes of lod-0 voxels, compared with the planes of the triangles in double.
#include <gtest/gtest.h>

#include "bake_scene.h"
#include "core/octree/plane.h"
#include "triangle_families.h"

namespace gigabake::reference {
namespace {

using namespace gigabake::kernels;

constexpr double voxel = 256;
constexpr std::int64_t middle = 8 * 256;

double in_range(Rng& rng, double low, double high) { return std::uniform_real_distribution<double>(low, high)(rng); }

Direction unit_direction(Rng& rng) {
  for (;;) {
    const Direction d{in_range(rng, -1, 1), in_range(rng, -1, 1), in_range(rng, -1, 1)};
    if (dot(d, d) > 0.01 && dot(d, d) < 1) return d / length(d);
  }
}

LatticeVertex rounded(const Direction& p) { return {std::llround(p[0]), std::llround(p[1]), std::llround(p[2])}; }

/// Returns a triangle around `centre`, sub-voxels, whose normal is about `normal`.
Triangle sheet_of(const Direction& centre, const Direction& normal, double edge) {
  const Direction any = std::abs(normal[0]) < 0.9 ? Direction{1, 0, 0} : Direction{0, 1, 0};
  const Direction u = cross(normal, any) / length(cross(normal, any)), v = cross(normal, u);
  return {rounded(centre + u * edge), rounded(centre + (v * 0.9 - u * 0.5) * edge),
          rounded(centre - (v * 0.9 + u * 0.5) * edge)};
}

Direction normal_of_sheet(const Triangle& t) {
  const auto n = normal_of(t);
  const Direction d{n[0].get_d(), n[1].get_d(), n[2].get_d()};
  return d / length(d);
}

Direction centre_of(const Voxel& at) {
  return Direction{double(at[0]) + 0.5, double(at[1]) + 0.5, double(at[2]) + 0.5} * voxel;
}

/// Returns the signed distance from the voxel's centre to its stored plane along its stored normal, voxels.
double stored_distance(const BakedVoxel& baked) {
  const OctahedronPoint n = octahedron_point(baked.normal.data());
  const double squared = dot(Direction(n.c), Direction(n.c));
  return unpack_plane(baked.directional_coverage[directional_coverage_plane]).offset / 14.0 * 127 / std::sqrt(squared);
}

/// Returns the largest error of a stored plane along its normal, voxels. It has three parts: half a step of the offset,
/// the rounding of a fragment's distance, and 0.96° of the normal at the voxel's corner.
double plane_error(const BakedVoxel& baked) {
  const Direction n(octahedron_point(baked.normal.data()).c);
  return 127 / (28 * length(n)) + 0.004 + 0.015;
}

bool is_planar(const BakedVoxel& baked) {
  return is_fully_planar(baked.directional_coverage[directional_coverage_plane]);
}

TEST(FinestPlanes, LieOnTheTriangle) {
  const std::uint64_t seed = 91;
  Rng rng(seed);
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", triangle " + std::to_string(i));
    BakeScene scene;
    const Direction centre{in_range(rng, 1500, 2500), in_range(rng, 1500, 2500), in_range(rng, 1500, 2500)};
    const Triangle t = sheet_of(centre, unit_direction(rng), in_range(rng, 300, 3000));
    scene.add_triangle(t, 0);
    const Direction n = normal_of_sheet(t);
    const VoxelMap voxels = voxels_at(scene.bake(), scene.parameters, 0);
    ASSERT_FALSE(voxels.empty());
    for (const auto& [at, baked] : voxels) {
      ASSERT_TRUE(is_planar(baked));
      const double distance = dot(n, Direction(t[0]) - centre_of(at)) / voxel;
      ASSERT_NEAR(stored_distance(baked), distance, plane_error(baked));
    }
  }
}

/// A wall of 0.3 voxel whose two sides lie in the same voxels. Its normal is that of either side, and its plane lies
/// between the sides.
TEST(FinestPlanes, OfThinWallsLieBetweenTheSides) {
  const std::uint64_t seed = 92;
  Rng rng(seed);
  std::size_t both = 0;
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", wall " + std::to_string(i));
    BakeScene scene;
    const Direction n = unit_direction(rng), centre{middle + 10.0, middle - 20.0, middle + 30.0};
    const Triangle front = sheet_of(centre + n * (0.15 * voxel), n, 2500),
                   back = sheet_of(centre - n * (0.15 * voxel), n * -1, 2500);
    scene.add_triangle(front, 0);
    scene.add_triangle(back, 0);
    const VoxelMap baked = voxels_at(scene.bake(), scene.parameters, 0);
    for (const auto& [at, value] : baked) {
      const Direction stored = direction_of(value.normal);
      const double off = std::min(angle_deg(stored, n), angle_deg(stored, n * -1));
      ASSERT_LE(off, octahedral_error_deg + 1);
      const double from_middle = std::abs(dot(n, centre - centre_of(at)) / voxel);
      if (from_middle > 0.2 || !is_planar(value)) continue;
      ++both;
      const double distance = stored_distance(value) * (angle_deg(stored, n) < 90 ? 1 : -1);
      ASSERT_NEAR(distance, dot(n, centre - centre_of(at)) / voxel, 0.15 + plane_error(value));
    }
  }
  EXPECT_GT(both, 1000u);
}

TEST(FinestPlanes, AreAbsentFromRightAnglesAndTranslucentVoxels) {
  BakeScene scene;
  const std::int64_t at = middle + 100, far = middle + 1500;
  scene.add_triangle({{{at, middle - 900, at}, {far, middle, at}, {at, middle + 900, at}}}, 0);
  scene.add_triangle({{{at, middle - 900, at}, {at, middle + 900, at}, {at, middle, far}}}, 0);
  const auto corner = voxels_at(scene.bake(), scene.parameters, 0).find({8, 8, 8});
  EXPECT_FALSE(is_planar(corner->second));
  BakeScene glass;
  glass.add_triangle({{{at, middle - 900, at}, {far, middle, at}, {at, middle + 900, at}}},
                     glass.add_colour({1000, 1000, 1000, 30000}, AlphaMode::blend));
  for (const auto& [place, value] : voxels_at(glass.bake(), glass.parameters, 0))
    ASSERT_EQ(value.directional_coverage, DirectionalCoverage{});
}

TEST(FinestPlanes, AreAbsentWithoutNormalsOrDirectionalCoverage) {
  for (const auto& omit :
       {+[](CellParameters& p) { p.normals = false; }, +[](CellParameters& p) { p.directional_coverage = false; },
        +[](CellParameters& p) { p.mip = MipFilter::box; }}) {
    BakeScene scene;
    omit(scene.parameters);
    scene.add_triangle({{{middle, middle, 100}, {middle + 900, middle, 200}, {middle, middle + 900, 300}}}, 0);
    EXPECT_TRUE(scene.bake().levels[0].directional_coverage.empty());
  }
}

/// Lod-0 voxels have planes and coarser voxels do not, so each level has constant nodes.
TEST(FinestPlanes, OfAFilledBlockAreConstantNodesOnEachLevel) {
  BakeScene scene;
  scene.set_window({0, 0, 0}, 64);
  std::vector<Triangle> layers;
  for (std::int64_t z = 128; z < 64 * 256; z += 256) {
    layers.push_back({{{0, 0, z}, {64 * 256, 0, z}, {64 * 256, 64 * 256, z}}});
    layers.push_back({{{0, 0, z}, {64 * 256, 64 * 256, z}, {0, 64 * 256, z}}});
  }
  scene.add_mesh(layers);
  const CellVolume volume = scene.bake();
  EXPECT_EQ(volume.nodes.kind.size(), 1u + 8 + 64 + 512);
  for (std::size_t n = 0; n < volume.nodes.kind.size(); ++n)
    EXPECT_EQ(volume.nodes.kind[n], volume.nodes.lod[n] == 0 ? NodeKind::leaf_constant : NodeKind::constant);
  for (const Level& level : volume.levels) EXPECT_TRUE(level.key.empty());
  const VoxelMap voxels = voxels_at(volume, scene.parameters, 0);
  EXPECT_EQ(voxels.size(), 64u * 64 * 64);
  for (const auto& [at, voxel] : voxels) {
    ASSERT_TRUE(is_planar(voxel));
    ASSERT_EQ(voxel.directional_coverage, voxels.begin()->second.directional_coverage);
  }
}

}  // namespace
}  // namespace gigabake::reference
