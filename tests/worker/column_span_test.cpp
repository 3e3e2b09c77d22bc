#include "worker/scan/column_span.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <utility>

#include "core/octree/morton.h"
#include "kernels/cpu/bake_cell.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using Columns = std::map<std::pair<std::int64_t, std::int64_t>, VoxelSpan>;

constexpr std::uint64_t no_limit = std::uint64_t(1) << 40;

Columns columns_of(const LatticeTriangle& t, const ColumnGrid& grid) {
  Columns found;
  EXPECT_TRUE(for_each_column(t, grid, no_limit, [&](std::int64_t x, std::int64_t y, VoxelSpan z) {
    EXPECT_TRUE(found.emplace(std::pair(x, y), z).second) << "column " << x << ", " << y << " visited twice";
  }));
  return found;
}

/// Bakes a triangle in a window at 0,0,0 and calls visit for each voxel. The vertices must be exact as float.
template <class Visit>
void for_each_baked_voxel(const LatticeTriangle& t, SurfaceRule rule, const Visit& visit) {
  std::vector<float> position;
  for (const Vec3i64& p : t.p) position.insert(position.end(), p.begin(), p.end());
  const std::vector<std::uint32_t> index{0, 1, 2};
  kernels::PartView part;
  part.position = {position.data(), position.size()};
  part.index = {index.data(), index.size()};
  for (int i = 0; i < 3; ++i) part.scene_from_local[5 * i] = 1;
  const kernels::MaterialView white;
  kernels::CellParameters parameters;
  parameters.frame.voxel_size_m = 256;  // one metre is one sub-voxel
  parameters.window_voxels = 64;
  parameters.surface = rule;
  static const ThreadPool pool(1);
  const auto volume = kernels::bake_cell({{&part, 1}, {&white, 1}, {}}, parameters, pool);
  if (volume.levels.empty()) return;
  const kernels::Level& level = volume.levels[0];
  for (std::size_t b = 0; b < level.key.size(); ++b) {
    const auto brick = demorton(level.key[b]);
    for (int v = 0; v < 512; ++v)
      if (level.mask[8 * b + std::size_t(v / 64)] >> (v % 64) & 1)
        visit(std::int64_t(8 * brick.x) + v % 8, std::int64_t(8 * brick.y) + v / 8 % 8,
              std::int64_t(8 * brick.z) + v / 64);
  }
}

LatticeTriangle random_triangle(std::mt19937_64& rng, std::int64_t extent, std::int64_t step) {
  std::uniform_int_distribution<std::int64_t> at(0, extent / step);
  LatticeTriangle t;
  do {
    for (auto& p : t.p)
      for (auto& c : p) c = at(rng) * step;
  } while (!has_area(t));
  return t;
}

TEST(ForEachColumn, HoldsEveryVoxelThatTheKernelsOccupyUnderAnySurfaceRule) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (int round = 0; round < 600; ++round) {
    // Steps of 256 and 128 put vertices on voxel corners and centres, where ties occur.
    const LatticeTriangle t = random_triangle(rng, 64 * 256 - 256, std::array{1, 128, 256}[std::size_t(round % 3)]);
    for (const auto rule : {SurfaceRule::area, SurfaceRule::conservative, SurfaceRule::thin}) {
      const ColumnGrid grid{3 + round % 2, rule != SurfaceRule::area};
      const Columns columns = columns_of(t, grid);
      for_each_baked_voxel(t, rule, [&](std::int64_t x, std::int64_t y, std::int64_t z) {
        const auto at = columns.find({x >> grid.cell_bits, y >> grid.cell_bits});
        ASSERT_NE(at, columns.end()) << "voxel " << x << ", " << y << ", round " << round;
        EXPECT_TRUE(at->second.first <= z && z <= at->second.last)
            << "voxel " << x << ", " << y << ", " << z << ", round " << round;
      });
    }
  }
}

TEST(ForEachColumn, HoldsPointsOfTrianglesOfAnySizeAndSlope) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int round = 0; round < 1000; ++round) {
    LatticeTriangle t = random_triangle(rng, std::int64_t(1) << (1 + rng() % 34), 1);
    if (round % 3 == 0)
      for (auto& p : t.p) p[rng() % 2] >>= 20;  // steep and narrow
    if (!has_area(t)) continue;
    const ColumnGrid grid{int(3 + rng() % 8), true};
    const int bits = grid.cell_bits + 8;
    Columns columns;
    if (!for_each_column(t, grid, 5000, [&](std::int64_t x, std::int64_t y, VoxelSpan z) { columns[{x, y}] = z; }))
      continue;
    for (int sample = 0; sample < 200; ++sample) {
      double a = unit(rng), b = unit(rng);
      if (a + b > 1) a = 1 - a, b = 1 - b;
      const Vec3d inside = Vec3d(t.p[1] - t.p[0]) * a + Vec3d(t.p[2] - t.p[0]) * b;
      // a point within a sub-voxel of the triangle
      const Vec3i64 q = t.p[0] + Vec3i64::by_axis([&](std::size_t c) { return std::int64_t(std::floor(inside[c])); });
      const auto at = columns.find({q[0] >> bits, q[1] >> bits});
      ASSERT_NE(at, columns.end()) << "round " << round;
      EXPECT_TRUE(at->second.first <= (q[2] >> 8) && (q[2] >> 8) <= at->second.last) << "round " << round;
    }
  }
}

TEST(ForEachColumn, FollowsTheTriangleAndNotItsBoundingBox) {
  const LatticeTriangle sliver{{{0, 0, 0}, {1 << 28, 1 << 28, 1 << 28}, {1 << 28, (1 << 28) + 600, 1 << 28}}};
  const Columns columns = columns_of(sliver, {10, false});  // 1024 columns along the diagonal
  EXPECT_GE(columns.size(), 1024u);
  EXPECT_LT(columns.size(), 3 * 1024u);
  for (const auto& [column, z] : columns) EXPECT_LE(z.last - z.first, 1024 + 8);
}

TEST(ForEachColumn, GivesAFlatTriangleOnColumnBordersNoNeighbours) {
  const std::int64_t edge = 8 * 256;
  const LatticeTriangle square_half{{{0, 0, 0}, {2 * edge, 0, 0}, {0, 2 * edge, 0}}};
  const Columns open = columns_of(square_half, {3, false});
  for (const auto& [column, z] : open) {
    EXPECT_TRUE(column.first >= 0 && column.first < 2 && column.second >= 0 && column.second < 2);
    EXPECT_EQ(z.first, 0);
    EXPECT_EQ(z.last, 0);
  }
  EXPECT_EQ(columns_of(square_half, {3, true}).count({-1, -1}), 1u);
}

TEST(ForEachColumn, GivesUpWhenATriangleHasMoreColumnsThanAllowed) {
  const std::int64_t far = std::int64_t(1) << 45;
  const auto ignore = [](std::int64_t, std::int64_t, VoxelSpan) {};
  EXPECT_FALSE(for_each_column({{{0, 0, 0}, {far, 0, 0}, {0, far, 0}}}, {3, false}, 1 << 21, ignore));
  EXPECT_FALSE(for_each_column({{{-far, 5, 0}, {far, 5, 0}, {0, 5, 100}}}, {3, false}, 1 << 21, ignore));
  EXPECT_FALSE(for_each_column({{{5, -far, 0}, {5, far, 0}, {5, 0, 100}}}, {3, false}, 1 << 21, ignore));
}

TEST(HasArea, IsFalseForCollinearVerticesHoweverFarApart) {
  const std::int64_t far = std::int64_t(1) << 53;
  EXPECT_FALSE(has_area({{{-far, -far, -far}, {0, 0, 0}, {far, far, far}}}));
  EXPECT_TRUE(has_area({{{-far, -far, -far}, {0, 0, 1}, {far, far, far}}}));
}

}  // namespace
}  // namespace gigabake
