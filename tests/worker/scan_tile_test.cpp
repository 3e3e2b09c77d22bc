#include "worker/scan/scan_tile.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <map>

#include "core/math/snap.h"
#include "glb_scene.h"
#include "worker/pipeline/lattice.h"

namespace gigabake {
namespace {

BakeParameters fine_lattice() {
  BakeParameters p;
  p.voxel_size_m = 0.25;
  p.cell_voxels = 16;
  return p;
}

TileScan scan(const std::filesystem::path& folder, const std::string& file, const BakeParameters& parameters,
              int threads = 2) {
  const ThreadPool pool(threads);
  return scan_tile(sources_of(folder, {file}), 0, parameters, pool);
}

TEST(ScanTile, HoldsEveryVertexInItsColumnsRangeAndEndsWhereTheGroundEnds) {
  const ScratchFolder folder;
  const GlbMesh mesh = rolling_ground(20, -7, 3);
  write_glb(folder.path() / "ground.glb", mesh);
  BakeParameters parameters = fine_lattice();
  parameters.surface = SurfaceRule::conservative;  // a vertex on a voxel's face touches the voxel
  const TileScan s = scan(folder.path(), "ground.glb", parameters);
  ASSERT_EQ(s.error, "");
  EXPECT_EQ(s.triangles, 800u);
  EXPECT_EQ(s.columns.size(), 6u * 6u);  // x from -28 to 52 voxels and y from 12 to 92: columns -2…3 and 0…5
  std::map<std::pair<std::int64_t, std::int64_t>, ColumnExtent> columns;
  for (const ColumnExtent& c : s.columns) columns[{c.column_x, c.column_y}] = c;
  for (std::size_t i = 0; i < mesh.position.size(); i += 3) {
    const auto voxel = [&](double metres) { return std::int64_t(std::floor(metres / parameters.voxel_size_m)); };
    const std::int64_t x = voxel(mesh.position[i]), y = voxel(-double(mesh.position[i + 2])),
                       z = voxel(mesh.position[i + 1]);
    ASSERT_TRUE(columns.count({x >> 4, y >> 4})) << x << ", " << y;
    const ColumnExtent& c = columns.at({x >> 4, y >> 4});
    EXPECT_TRUE(c.z_min <= z && z < c.z_end) << x << ", " << y << ", " << z;
    EXPECT_LT(c.z_end - c.z_min, 30);
  }
}

/// 2026-11-26: default cameras frame the bounds, so they must be tight.
TEST(ScanTile, BoundsTheVoxelsOfTheTile) {
  const ScratchFolder folder;
  GlbMesh floor;  // 20 × 10 m, level at 3 m
  floor.position = {-10, 3, -5, 10, 3, -5, 10, 3, 5, -10, 3, 5};
  floor.index = {0, 2, 1, 0, 3, 2};
  write_glb(folder.path() / "floor.glb", floor);
  const TileScan s = scan(folder.path(), "floor.glb", fine_lattice());
  ASSERT_EQ(s.error, "");
  EXPECT_EQ(s.bounds, (Box3i64{{-40, -20, 12}, {40, 20, 13}}));
  for (const ColumnExtent& c : s.columns) EXPECT_TRUE(s.bounds.min[2] <= c.z_min && c.z_end <= s.bounds.end[2]);
}

/// 2026-11-22: plans estimate voxels and bytes from the projected voxels of the columns.
TEST(ScanTile, SaysHowManyVoxelsItsSurfaceCrosses) {
  const ScratchFolder folder;
  GlbMesh floor;  // 20 × 20 m, level: 80 × 80 voxels; x right, z towards the eye
  floor.position = {-10, 0, -10, 10, 0, -10, 10, 0, 10, -10, 0, 10};
  floor.index = {0, 2, 1, 0, 3, 2};
  GlbMesh slope = floor;  // it rises by its width, so it is as large from the side as from above
  slope.position[4] = slope.position[7] = 20;
  const auto projected_voxels = [&](const GlbMesh& mesh) {
    write_glb(folder.path() / "mesh.glb", mesh);
    double sum = 0;
    for (const ColumnExtent& c : scan(folder.path(), "mesh.glb", fine_lattice()).columns)
      sum += double(c.projected_voxels);
    return sum / projected_voxel_unit;
  };
  EXPECT_NEAR(projected_voxels(floor), 6400, 0.1);  // a triangle's fraction of a column is rounded down
  EXPECT_NEAR(projected_voxels(slope), 12800, 0.1);
}

TEST(ScanTile, IsEqualForAnyNumberOfThreads) {
  const ScratchFolder folder;
  write_glb(folder.path() / "ground.glb", rolling_ground(150, 0, 0));
  const TileScan one = scan(folder.path(), "ground.glb", fine_lattice(), 1);
  for (int threads : {2, 5}) {
    const TileScan many = scan(folder.path(), "ground.glb", fine_lattice(), threads);
    EXPECT_EQ(one.bounds, many.bounds);
    ASSERT_EQ(one.columns.size(), many.columns.size());
    for (std::size_t i = 0; i < one.columns.size(); ++i) {
      const ColumnExtent &a = one.columns[i], &b = many.columns[i];
      EXPECT_TRUE(a.column_x == b.column_x && a.column_y == b.column_y && a.z_min == b.z_min && a.z_end == b.z_end &&
                  a.triangles == b.triangles && a.projected_voxels == b.projected_voxels);
    }
  }
}

TEST(ScanTile, DropsAndCountsTrianglesThatAreNotFiniteOrHaveNoArea) {
  const ScratchFolder folder;
  GlbMesh mesh;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  mesh.position = {0, 0, 0, 1, 0, 0, 0, 0, -1, nan, 0, 0, 1e-5f, 0, 0, 2, 0, 0, 1e30f, 0, 0};
  mesh.index = {0, 1, 2, /* good */ 0,    1, 3, /* NaN */ 0,       1, 6, /* off the lattice */
                0, 0, 1, /* no area */ 0, 1, 5, /* collinear */ 0, 4, 2 /* none left after the snap */};
  write_glb(folder.path() / "odd.glb", mesh);
  const TileScan s = scan(folder.path(), "odd.glb", fine_lattice());
  ASSERT_EQ(s.error, "");  // 2026-11-22: a reader that refuses the file skipped this test
  EXPECT_EQ(s.triangles, 6u);
  EXPECT_EQ(s.non_finite, 1u);
  EXPECT_EQ(s.too_far, 1u);  // 1e30 m away; 2026-11-22: it was counted with NaN
  EXPECT_EQ(s.zero_area, 3u);
  ASSERT_EQ(s.columns.size(), 1u);
  EXPECT_EQ(s.columns[0].triangles, 1u);
}

TEST(ScanTile, NamesWhatItScannedByItsContent) {
  const ScratchFolder folder;
  write_glb(folder.path() / "a.glb", rolling_ground(4, 0, 0));
  write_glb(folder.path() / "b.glb", rolling_ground(4, 0, 0));
  write_glb(folder.path() / "c.glb", rolling_ground(4, 0, 1));
  const auto source = [&](const char* file) { return scan(folder.path(), file, fine_lattice()).source; };
  EXPECT_NE(source("a.glb"), Hash128{});
  EXPECT_EQ(source("a.glb"), source("b.glb"));
  EXPECT_NE(source("a.glb"), source("c.glb"));
}

TEST(ScanTile, SaysWhichFilesItReadAsTheyWereBefore) {
  const ScratchFolder folder;
  write_glb(folder.path() / "a.glb", rolling_ground(4, 0, 0));
  const TileScan s = scan(folder.path(), "a.glb", fine_lattice());
  ASSERT_EQ(s.files.size(), 1u);
  EXPECT_EQ(s.files[0].name, "a.glb");
  EXPECT_EQ(s.files[0].stamp, stamp_of(folder.path() / "a.glb"));
  EXPECT_FALSE(s.files[0].settled) << "it was written just now";
}

TEST(ScanTile, SaysInOneLineWhyATileCannotBeRead) {
  const ScratchFolder folder;
  std::ofstream(folder.path() / "torn.glb") << "glTF";
  for (const char* file : {"torn.glb", "absent.glb"}) {
    const TileScan s = scan(folder.path(), file, fine_lattice());
    EXPECT_NE(s.error.find(file), std::string::npos) << s.error;
    EXPECT_EQ(s.error.find('\n'), std::string::npos);
    EXPECT_TRUE(s.columns.empty());
  }
}

TEST(ScanTile, RefusesATileThatSpreadsOverMillionsOfColumns) {
  const ScratchFolder folder;
  GlbMesh mesh;
  mesh.position = {0, 0, 0, 4e4f, 0, 0, 0, 0, -4e4f};  // within reach
  mesh.index = {0, 1, 2};
  write_glb(folder.path() / "world.glb", mesh);
  BakeParameters fine = fine_lattice();
  fine.voxel_size_m = 0.01;
  const TileScan s = scan(folder.path(), "world.glb", fine);
  EXPECT_NE(s.error.find("`voxel_size_m`"), std::string::npos) << s.error;
  EXPECT_TRUE(s.columns.empty());
  BakeParameters coarse = fine_lattice();
  coarse.voxel_size_m = 1;
  coarse.cell_voxels = 4096;
  EXPECT_EQ(scan(folder.path(), "world.glb", coarse).error, "");
}

}  // namespace
}  // namespace gigabake
