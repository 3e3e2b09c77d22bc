#include "scheduler/plan/plan.h"

#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>
#include <set>

#include "format/job/fingerprint.h"
#include "scheduler/plan/merge.h"
#include "scheduler/plan/overviews.h"

namespace gigabake {
namespace {

constexpr unsigned plan_seed = 77;

BakeParameters parameters(std::uint32_t cell_voxels) {
  BakeParameters p;
  p.voxel_size_m = 0.5;
  p.cell_voxels = cell_voxels;
  return p;
}

std::vector<TileScan> random_scans(std::uint32_t tiles, std::mt19937& random) {
  std::vector<TileScan> scans(tiles);
  const auto below = [&random](int n) { return std::int64_t(random() % unsigned(n)); };
  for (std::uint32_t t = 0; t < tiles; ++t) {
    scans[t].tile = t;
    scans[t].source = {t + 1, 0};
    std::set<std::pair<std::int64_t, std::int64_t>> used;
    for (int c = 0; c < 5; ++c) {
      const std::int64_t x = below(4) - 2, y = below(4) - 2, z = below(5000) - 2500;
      if (used.insert({x, y}).second)
        scans[t].columns.push_back({x, y, z, z + 1 + below(700), std::uint64_t(1 + below(1000))});
    }
  }
  return scans;
}

SceneSources sources_of(std::size_t tiles, const std::string& name = "tile") {
  SceneSources sources;
  sources.tiles.resize(tiles);
  for (TileRef& tile : sources.tiles) tile.name = name;
  return sources;
}

TEST(StackOver, CoversTheHeightWithMinCellsOnTheLevelsLattice) {
  std::mt19937 random(plan_seed);
  for (int i = 0; i < 100000; ++i) {
    const std::int64_t n = std::int64_t(8) << (random() % 8), low = std::int64_t(random() % 20001) - 10000;
    const std::int64_t end = low + 1 + std::int64_t(random() % 3000);
    const CellStack s = stack_over(low, end, n);
    ASSERT_LE(s.z_min, low) << "seed " << plan_seed << " item " << i;
    ASSERT_GE(s.z_min + s.cells * n, end);
    const std::int64_t coarsest_voxel = std::max<std::int64_t>(8, n / 8);
    ASSERT_EQ(s.z_min % coarsest_voxel, 0);
    // A stack has one cell more than its height needs only if no start at a multiple of the coarsest voxel avoids it.
    const std::int64_t minimum = (end - low + n - 1) / n;
    ASSERT_LE(s.cells, minimum + 1);
    ASSERT_TRUE(s.cells == minimum || end - low + coarsest_voxel - 1 > minimum * n);
  }
}

TEST(StackOver, IsCentredOnTheHeight) {
  const CellStack s = stack_over(-100, 100, 1024);
  EXPECT_EQ(s.z_min, -512);
  EXPECT_EQ(s.cells, 1);
}

/// 2026-11-25: counts were part of a warning's text, so each file had a separate line.
TEST(MakePlan, AddsUpTheWarningsOfAKindAndListsLosses) {
  SourceWarnings warnings;
  warnings.count("lines not understood", "line 1");
  warnings.count("lines not understood", "line 2");
  warnings.count_loss("faces that cannot be used", "line 5");
  std::vector<TileScan> scans(3);
  for (std::uint32_t t = 0; t < scans.size(); ++t) scans[t].tile = t;
  scans[0].warnings = warnings.take();
  EXPECT_TRUE(warnings.take().empty());
  warnings.count("lines not understood", "line 9");
  scans[1].warnings = scans[2].warnings = warnings.take();
  SceneSources sources = sources_of(3, "b.obj");  // one file with two placements counts once
  sources.tiles[0].name = "a.obj";
  const BakePlan plan = make_plan(scans, sources, parameters(256));
  EXPECT_THAT(plan.warnings, testing::ElementsAre("a.obj and 1 more: lines not understood: 3, e.g. line 1"));
  ASSERT_EQ(plan.losses.size(), 1u);
  EXPECT_EQ(plan.losses[0].name, "a part of tile a.obj");
  EXPECT_EQ(plan.losses[0].reason, "faces that cannot be used: 1, e.g. line 5");
}

TEST(MakePlan, HandsEveryTileToEveryCellThatItReaches) {
  std::mt19937 random(plan_seed);
  for (int round = 0; round < 50; ++round) {
    const auto scans = random_scans(12, random);
    const std::int64_t n = 256;
    const BakePlan plan = make_plan(scans, sources_of(12), parameters(256));
    for (const TileScan& s : scans)
      for (const ColumnExtent& c : s.columns)
        for (std::int64_t z = c.z_min; z < c.z_end; ++z) {
          const auto holds = [&](const CellJob& j) {
            return j.lattice_min[0] == c.column_x * n && j.lattice_min[1] == c.column_y * n && z >= j.lattice_min[2] &&
                   z < j.lattice_min[2] + n && std::binary_search(j.tiles.begin(), j.tiles.end(), s.tile);
          };
          ASSERT_EQ(std::count_if(plan.jobs.begin(), plan.jobs.end(), holds), 1)
              << "seed " << plan_seed << " round " << round;
        }
  }
}

TEST(MakePlan, TellsEachCellWhatItsTilesHeldWhenTheyWereScanned) {
  std::mt19937 random(plan_seed);
  const auto scans = random_scans(12, random);
  for (const CellJob& job : make_plan(scans, sources_of(12), parameters(256)).jobs) {
    ASSERT_EQ(job.tile_sources.size(), job.tiles.size());
    for (std::size_t i = 0; i < job.tiles.size(); ++i) EXPECT_EQ(job.tile_sources[i], scans[job.tiles[i]].source);
  }
}

TEST(MakePlan, ListsTheOverviewsAfterTheSameCells) {
  std::mt19937 random(plan_seed);
  const auto scans = random_scans(20, random);
  std::vector<CellJob> expected = make_plan(scans, sources_of(20), parameters(128)).jobs;
  const std::size_t cells = expected.size();
  add_overviews(expected);
  const BakePlan plan = make_plan(scans, sources_of(20), parameters(128), PlanLevels::cells_and_overviews);
  EXPECT_EQ(plan.cells(), cells);
  ASSERT_EQ(plan.jobs.size(), expected.size());
  ASSERT_GT(plan.jobs.size(), cells);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(plan.jobs[i].id, i);
    EXPECT_EQ(is_overview(plan.jobs[i]), i >= cells);
    EXPECT_EQ(plan.jobs[i].fingerprint, expected[i].fingerprint);
    EXPECT_EQ(plan.jobs[i].kept_lod, expected[i].kept_lod);
  }
}

TEST(MakePlan, DoesNotDependOnTheOrderOfScans) {
  std::mt19937 random(plan_seed);
  auto scans = random_scans(20, random);
  const BakePlan a = make_plan(scans, sources_of(20), parameters(128));
  std::shuffle(scans.begin(), scans.end(), random);
  const BakePlan b = make_plan(scans, sources_of(20), parameters(128));
  ASSERT_EQ(a.jobs.size(), b.jobs.size());
  for (std::size_t i = 0; i < a.jobs.size(); ++i) {
    EXPECT_EQ(a.jobs[i].name, b.jobs[i].name);
    EXPECT_EQ(a.jobs[i].fingerprint, b.jobs[i].fingerprint);
    EXPECT_EQ(a.jobs[i].id, i);
  }
}

TEST(MakePlan, ChangesTheFingerprintsOfTheCellsThatATileReachesAndOfNoOther) {
  std::mt19937 random(plan_seed);
  auto scans = random_scans(20, random);
  const BakePlan a = make_plan(scans, sources_of(20), parameters(128));
  scans[7].source.lo ^= 1;
  const BakePlan b = make_plan(scans, sources_of(20), parameters(128));
  for (std::size_t i = 0; i < a.jobs.size(); ++i) {
    const bool reached = std::binary_search(a.jobs[i].tiles.begin(), a.jobs[i].tiles.end(), 7u);
    EXPECT_EQ(a.jobs[i].fingerprint != b.jobs[i].fingerprint, reached) << a.jobs[i].name;
  }
}

TEST(CellFingerprints, DoNotDependOnTheOrderOfTilesButOnHowOftenEachIsThere) {
  std::mt19937 random(plan_seed);
  const CellFingerprints fingerprints(parameters(128), std::nullopt);
  const CellJob job;
  for (int round = 0; round < 100; ++round) {
    std::vector<Hash128> tiles(2 + random() % 20);
    for (Hash128& t : tiles) t = {random() % 4, random() % 3};
    const Hash128 expected = fingerprints.of(job, tiles);
    std::shuffle(tiles.begin(), tiles.end(), random);
    EXPECT_EQ(fingerprints.of(job, tiles), expected) << "seed " << plan_seed << " round " << round;
    tiles.push_back(tiles[0]);
    EXPECT_NE(fingerprints.of(job, tiles), expected) << "seed " << plan_seed << " round " << round;
  }
}

/// The values stay the same until kernel_version or fingerprint_version is raised; every cell is then baked again. On
/// 2026-11-25 both were raised: ranks may have written different shards, and alpha tests changed. On 2026-11-26
/// kernel_version was raised: vertex normals shade voxels.
TEST(CellFingerprints, KeepTheirValuesSoThatOldBakesStayValid) {
  const CellFingerprints local(parameters(128), std::nullopt), placed(parameters(128), Geodetic{46.5, 8.25, 600});
  CellJob job;
  job.lattice_min = {-128, 256, 8};
  job.cell_voxels = 128;
  EXPECT_EQ(local.of(job, {{1, 2}, {3, 4}}).hex(), "f761b9855ca2c692b2659d155a4398d9");
  EXPECT_EQ(placed.of(job, {{5, 6}}).hex(), "e208ef24b8d0c6528b652576c6690129");
}

TEST(MakePlan, ListsWhatTheSourceLacksThenTilesThatCouldNotBeRead) {
  std::vector<TileScan> scans(1);
  scans[0].error = "a.glb: truncated";
  SceneSources sources = sources_of(1, "a.glb");
  sources.skipped = {{"x", "points", true}, {"y", "missing", false}};
  const BakePlan plan = make_plan(scans, sources, parameters(64));
  ASSERT_EQ(plan.losses.size(), 2u);
  EXPECT_EQ(plan.losses[0].name, "y");
  EXPECT_EQ(plan.losses[1].name, "tile a.glb");
  EXPECT_TRUE(plan.jobs.empty());
}

TEST(MakePlan, RefusesATileThatNeedsMillionsOfCellsAndBakesTheOthers) {
  std::vector<TileScan> scans(2);
  scans[0].columns = {{0, 0, -(std::int64_t(1) << 40), std::int64_t(1) << 40, 1}};
  scans[1].tile = 1;
  scans[1].columns = {{0, 0, 0, 10, 1}};
  const BakePlan plan = make_plan(scans, sources_of(2), parameters(64));
  ASSERT_EQ(plan.losses.size(), 1u);
  EXPECT_NE(plan.losses[0].reason.find("`voxel_size_m`"), std::string::npos) << plan.losses[0].reason;
  ASSERT_EQ(plan.jobs.size(), 1u);
  EXPECT_EQ(plan.jobs[0].tiles, std::vector<std::uint32_t>{1});
}

TEST(MakePlan, LeavesOutTheEmptyMiddleOfATallStack) {
  std::vector<TileScan> scans(2);
  scans[0].columns = {{0, 0, 0, 10, 1}};
  scans[1].tile = 1;
  scans[1].columns = {{0, 0, 1000000, 1000010, 1}};
  EXPECT_LE(make_plan(scans, sources_of(2), parameters(64)).jobs.size(), 4u);
}

TEST(Merge, ListsCellsThatFailedAndThoseWithoutAReport) {
  BakePlan plan;
  plan.jobs.resize(3);
  for (std::uint32_t i = 0; i < 3; ++i) {
    plan.jobs[i].id = i;
    plan.jobs[i].name = "c_" + std::to_string(i);
  }
  CellReport baked, failed;
  baked.id = 2;
  baked.outcome = CellOutcome::baked;
  baked.cell.name = "c_2";
  failed.id = 0;
  failed.error = "no memory";
  plan.losses = {{"tile y", "missing"}};
  const SceneDescription scene = merge(plan, {failed, baked}, std::nullopt, parameters(64));
  ASSERT_EQ(scene.cells.size(), 1u);
  ASSERT_EQ(scene.losses.size(), 3u);
  EXPECT_EQ(scene.losses[0].name, "tile y");
  EXPECT_EQ(scene.losses[1].reason, "no memory");
  EXPECT_EQ(scene.losses[2].name, "cell c_1");
}

}  // namespace
}  // namespace gigabake
