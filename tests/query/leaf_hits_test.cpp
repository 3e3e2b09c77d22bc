// First hits of leaves, compared with all cubes of a cell, which are tested one by one in double precision.
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <vector>

#include "core/math/box3.h"
#include "first_hit_scenes.h"
#include "format/shard/levels/brick_walk.h"
#include "format/shard/levels/leaf_walk.h"
#include "kernels/cpu/bake_cell.h"
#include "query/first_hit/first_hit_cast.h"
#include "query/first_hit_scene.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using kernels::FirstHit;
using kernels::FirstHitRay;

constexpr std::int64_t cell_voxels = 128;
constexpr int leaf_levels = 4;

/// A cell with a slope at the coarsest of its levels, and small triangles of finer levels at corners of octants.
struct LeafCell {
  NodeTable nodes;
  std::vector<BrickLevel> levels;

  LeafCell() {
    const std::vector<float> slope{0, 0, 30, 128, 0, 30, 128, 128, 90, 0, 0, 30, 128, 128, 90, 0, 128, 90};
    std::vector<std::vector<float>> position{slope};
    for (const float at : {64.0f, 32.0f, 96.0f})
      position.push_back({at, at, at - 3, at + 3, at + 1, at, at, at + 3, at + 2});
    const std::vector<std::uint32_t> index{0, 1, 2, 3, 4, 5};
    std::vector<kernels::PartView> parts(position.size());
    for (std::size_t p = 0; p < parts.size(); ++p) {
      parts[p].position = {position[p].data(), position[p].size()};
      parts[p].index = {index.data(), position[p].size() / 3};
      for (const int diagonal : {0, 5, 10}) parts[p].scene_from_local[diagonal] = 1;
      parts[p].lod = p == 0 ? leaf_levels : int(p) - 1;
    }
    const kernels::MaterialView white;
    kernels::CellParameters parameters;
    parameters.window_voxels = cell_voxels;
    kernels::CellVolume volume =
        kernels::bake_cell({{parts.data(), parts.size()}, {&white, 1}, {}}, parameters, callers_thread());
    nodes = std::move(volume.nodes);
    for (kernels::Level& level : volume.levels) levels.push_back(std::move(static_cast<BrickLevel&>(level)));
  }

  /// Returns the cubes that describe level `lod`, in voxels of lod 0.
  std::vector<Box3i64> cubes(int lod) const {
    std::vector<Box3i64> cubes;
    for_each_voxel_of_level(
        nodes, levels[std::size_t(lod)], lod,
        [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t*, const std::int8_t*) {
          cubes.push_back(Box3i64::cube(Vec3i64{x, y, z} << lod, std::int64_t(1) << lod));
        });
    const std::vector<BrickLevel> from_lod(levels.begin() + lod, levels.end());
    for_each_leaf_octant(nodes, from_lod, lod, lod, [&](const LeafVoxels& octant) {
      for_each_leaf(octant,
                    [&](const Vec3<int>& at, const std::uint8_t*, const std::int8_t*, const std::uint8_t*, VoxelClass) {
                      cubes.push_back(Box3i64::cube((octant.octant * 4 + static_cast<Vec3i64>(at)) << octant.lod,
                                                    std::int64_t(1) << octant.lod));
                    });
    });
    return cubes;
  }
};

/// Returns the distance at which a ray enters a cube; infinity if it misses the cube. `margin` enlarges the cube.
double entry(const FirstHitRay& ray, const Box3i64& cube, double margin) {
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < 3; ++a) {
    const double low = double(cube.min[a]) - margin, high = double(cube.end[a]) + margin, d = double(ray.direction[a]);
    if (d == 0) {
      if (ray.origin[a] < low || ray.origin[a] > high) return leave;
      continue;
    }
    const double t = (low - ray.origin[a]) / d, u = (high - ray.origin[a]) / d;
    enter = std::max(enter, std::min(t, u)), leave = std::min(leave, std::max(t, u));
  }
  return enter <= leave ? enter : std::numeric_limits<double>::infinity();
}

TEST(LeafHits, AreTheNearestCubesOfAllLevels) {
  const LeafCell cell;
  for (int lod = 0; lod <= leaf_levels; ++lod) {
    FirstHitBuilder builder(lod);
    const std::vector<BrickLevel> from_lod(cell.levels.begin() + lod, cell.levels.end());
    builder.add_cell({0, 0, 0}, cell.nodes, from_lod.front());
    builder.add_leaves({0, 0, 0}, cell.nodes, from_lod, LeafShape::cube);
    const FirstHitScene scene = builder.finish();
    const std::vector<Box3i64> cubes = cell.cubes(lod);
    ASSERT_GT(cubes.size(), 50u);
    std::uint64_t volume = 0;
    for (const Box3i64& cube : cubes) volume += std::uint64_t(cube.size()[0] * cube.size()[1] * cube.size()[2]);
    EXPECT_EQ(scene.voxels << 3 * lod, volume);
    const std::vector<FirstHitRay> rays = first_hit_test::random_rays(2000, -20, 150);
    std::vector<FirstHit> hits(rays.size());
    kernels::cast_first_hits(scene.view, {rays.data(), rays.size()}, {{hits.data(), hits.size()}, {}},
                             callers_thread());
    int leaves = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      constexpr double margin = 1.0 / 64;
      double inner = std::numeric_limits<double>::infinity(), outer = inner;
      for (const Box3i64& cube : cubes) {
        inner = std::min(inner, entry(rays[i], cube, -margin));
        outer = std::min(outer, entry(rays[i], cube, margin));
      }
      const bool is_hit = hits[i].attributes_index != kernels::no_attributes;
      if (is_hit) {
        EXPECT_GE(double(hits[i].distance), outer - margin) << "lod " << lod << ", ray " << i;
      }
      if (std::isfinite(inner)) {
        EXPECT_TRUE(is_hit) << "lod " << lod << ", ray " << i;
        EXPECT_LE(double(hits[i].distance), inner + margin) << "lod " << lod << ", ray " << i;
      }
      if (is_hit && scene.attributes[hits[i].attributes_index].coarser != 0) ++leaves;
    }
    EXPECT_EQ(leaves > 100, lod < leaf_levels) << lod;
  }
}

}  // namespace
}  // namespace gigabake
