#include "format/scene/check/diff.h"

#include <gtest/gtest.h>
#include <map>
#include <random>

#include "core/base/error.h"
#include "tests/format/shard/made_shard.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using made::TempFolder;
using made::Voxel;

std::vector<Voxel> random_voxels(std::mt19937_64& rng, int count) {
  std::map<Vec3i64, Voxel> voxels;
  for (int i = 0; i < count; ++i) {
    Voxel v;
    for (std::int64_t& x : v.at) x = std::int64_t(rng() % 64) - 32;
    for (std::uint8_t& c : v.rgba) c = std::uint8_t(1 + rng() % 200);
    voxels[v.at] = v;
  }
  std::vector<Voxel> list;
  for (const auto& [at, v] : voxels) list.push_back(v);
  return list;
}

/// Splits the cube of 64 voxels around 0 into cells, and leaves out cells without voxels.
std::vector<Shard> cut(const std::vector<Voxel>& voxels, std::int64_t edge) {
  std::vector<Shard> shards;
  for (std::int64_t z = -32; z < 32; z += edge)
    for (std::int64_t y = -32; y < 32; y += edge)
      for (std::int64_t x = -32; x < 32; x += edge) {
        Shard s = made::shard_of(voxels, {x, y, z}, std::uint32_t(edge));
        if (!s.levels[0].rgba.empty()) shards.push_back(std::move(s));
      }
  return shards;
}

LevelDifference sum_of_lod(const SceneDifference& d, int lod) {
  LevelDifference sum;
  for (const CellDifference& cell : d.cells)
    for (const LevelDifference& l : cell.levels) {
      if (l.lod != lod) continue;
      sum.only_in_a += l.only_in_a;
      sum.only_in_b += l.only_in_b;
      sum.recoloured += l.recoloured;
      sum.turned += l.turned;
      for (std::size_t c = 0; c < 4; ++c) sum.maximum[c] = std::max(sum.maximum[c], l.maximum[c]);
    }
  return sum;
}

TEST(Diff, FindsTheSameVoxelsHoweverCellsAreCut) {
  std::mt19937_64 rng(1);
  const TempFolder folder;
  const std::vector<Voxel> voxels = random_voxels(rng, 3000);
  made::write_scene_of(folder / "a/scene.xml", cut(voxels, 64));
  made::write_scene_of(folder / "b/scene.xml", cut(voxels, 16));
  const SceneDifference d = diff_scenes(folder / "a/scene.xml", folder / "b/scene.xml");
  EXPECT_EQ(sum_of_lod(d, 0).only_in_a, 0u);
  EXPECT_FALSE(sum_of_lod(d, 0).any());
  EXPECT_EQ(d.compared, (std::vector{0, 1}));
  EXPECT_EQ(d.not_compared, (std::vector{2, 3}));
}

TEST(Diff, CountsWhatChangedHoweverCellsAreCut) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  for (int round = 0; round < 4; ++round) {
    const std::vector<Voxel> before = random_voxels(rng, 600);
    std::vector<Voxel> after;
    LevelDifference expected;
    for (Voxel v : before) {
      const std::uint64_t dice = rng() % 10;
      if (dice == 0) {
        ++expected.only_in_a;
        continue;
      }
      if (dice == 1) {
        ++expected.recoloured;
        v.rgba[1] = std::uint8_t(v.rgba[1] + 40);
      }
      if (dice == 2) {
        ++expected.turned;
        v.normal[0] = 1;
      }
      after.push_back(v);
    }
    const std::int64_t edges[] = {16, 32, 64};
    const std::int64_t edge_a = edges[rng() % 3], edge_b = edges[rng() % 3];
    made::write_scene_of(folder / "a/scene.xml", cut(before, edge_a));
    made::write_scene_of(folder / "b/scene.xml", cut(after, edge_b));
    SCOPED_TRACE("cells of " + std::to_string(edge_a) + " and " + std::to_string(edge_b));
    const LevelDifference d = sum_of_lod(diff_scenes(folder / "a/scene.xml", folder / "b/scene.xml"), 0);
    EXPECT_EQ(d.only_in_a, expected.only_in_a);
    EXPECT_EQ(d.only_in_b, 0u);
    EXPECT_EQ(d.recoloured, expected.recoloured);
    EXPECT_EQ(d.turned, expected.turned);
    EXPECT_EQ(d.maximum, (std::array{0, 40, 0, 0}));
    const LevelDifference back = sum_of_lod(diff_scenes(folder / "b/scene.xml", folder / "a/scene.xml"), 0);
    EXPECT_EQ(back.only_in_a, 0u);
    EXPECT_EQ(back.only_in_b, expected.only_in_a);
    EXPECT_EQ(back.recoloured, expected.recoloured);
  }
}

TEST(Diff, NamesTheCellThatDiffersAndByHowMuch) {
  const TempFolder folder;
  std::vector<Voxel> voxels{
      {{0, 0, 0}, {10, 20, 30, 255}, {}}, {{20, 0, 0}, {1, 1, 1, 255}, {}}, {{21, 0, 0}, {1, 1, 1, 255}, {}}};
  made::write_scene_of(folder / "a/scene.xml", cut(voxels, 16));
  voxels[1].rgba = {1, 4, 1, 255};
  voxels[2].rgba = {1, 2, 1, 245};
  made::write_scene_of(folder / "b/scene.xml", cut(voxels, 16));
  const SceneDifference d = diff_scenes(folder / "a/scene.xml", folder / "b/scene.xml");
  ASSERT_EQ(d.cells.size(), 1u);
  EXPECT_EQ(d.cells[0].cell_in_a, "c_16_0_0");
  EXPECT_EQ(d.cells[0].cell_in_b, "c_16_0_0");
  const LevelDifference& l = d.cells[0].levels[0];
  EXPECT_EQ(l.both, 2u);
  EXPECT_EQ(l.recoloured, 2u);
  EXPECT_EQ(l.maximum, (std::array{0, 3, 0, 10}));
  EXPECT_EQ(l.mean, (std::array<double, 4>{0, 2, 0, 5}));
}

TEST(Diff, CountsCellsThatOnlyOneSceneHas) {
  const TempFolder folder;
  const std::vector<Voxel> one{{{0, 0, 0}, {1, 1, 1, 255}, {}}};
  const std::vector<Voxel> two{one[0], {{20, 0, 0}, {1, 1, 1, 255}, {}}};
  made::write_scene_of(folder / "a/scene.xml", cut(one, 8));
  made::write_scene_of(folder / "b/scene.xml", cut(two, 8));
  const SceneDifference d = diff_scenes(folder / "a/scene.xml", folder / "b/scene.xml");
  ASSERT_EQ(d.cells.size(), 1u);
  EXPECT_EQ(d.cells[0].cell_in_a, "");
  EXPECT_EQ(d.cells[0].cell_in_b, "c_16_0_0");
  EXPECT_EQ(d.cells[0].levels[0].only_in_b, 1u);
}

TEST(Diff, SeesVoxelsInAConstantBranchAsThoseThatAreWrittenOut) {
  const TempFolder folder;
  std::vector<Voxel> solid;
  for (std::int64_t i = 0; i < 4096; ++i) solid.push_back({{i % 16, i / 16 % 16, i / 256}, {10, 20, 30, 255}, {3, 4}});
  Shard constant = made::shard_of(solid, {0, 0, 0}, 16);
  constant.nodes = {{0}, {1}, {NodeKind::leaf_constant}, {0}, {0xffffffffu}, {0xff1e140au}, {{3, 4}}, {}};
  for (BrickLevel& level : constant.levels) level = {{}, {0}, {}, {}, {}};
  solid[100].rgba[0] = 200;
  made::write_scene_of(folder / "a/scene.xml", {constant});
  made::write_scene_of(folder / "b/scene.xml", {made::shard_of(solid, {0, 0, 0}, 16)});
  const LevelDifference d = sum_of_lod(diff_scenes(folder / "a/scene.xml", folder / "b/scene.xml"), 0);
  EXPECT_EQ(d.only_in_a + d.only_in_b, 0u);
  EXPECT_EQ(d.recoloured, 1u);
  EXPECT_EQ(d.maximum[0], 190);
}

TEST(Diff, OfScenesOnDifferentLatticesIsAnError) {
  const TempFolder folder;
  Shard shard = made::small_shard();
  made::write_scene_of(folder / "a/scene.xml", {shard});
  shard.header.voxel_size_m *= 2;
  made::write_scene_of(folder / "b/scene.xml", {shard});
  EXPECT_THROW(diff_scenes(folder / "a/scene.xml", folder / "b/scene.xml"), InputError);
}

}  // namespace
}  // namespace gigabake
