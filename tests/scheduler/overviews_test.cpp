#include "scheduler/plan/overviews.h"

#include <bit>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <set>

#include "core/math/box3.h"
#include "scheduler/queue/overview_queue.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using testing::ElementsAre;

/// Returns cells at random places of the lattice, including clusters far apart; their stacks begin at any voxel of the
/// coarsest level.
std::vector<CellJob> scattered_cells(std::mt19937& random, std::uint32_t cell_voxels) {
  const std::int64_t n = cell_voxels, step = std::max<std::int64_t>(8, n / 8);
  std::vector<CellJob> jobs;
  std::set<std::pair<std::int64_t, std::int64_t>> columns;
  const int clusters = 1 + int(random() % 3);
  for (int c = 0; c < clusters; ++c) {
    const std::int64_t x = std::int64_t(random() % 4001) - 2000, y = std::int64_t(random() % 41) - 20;
    for (int k = 0; k < 40; ++k) columns.insert({x + std::int64_t(random() % 12), y + std::int64_t(random() % 12)});
  }
  for (const auto& [x, y] : columns) {
    const std::int64_t z = (std::int64_t(random() % 64) - 32) * step;
    for (std::int64_t level = 0; level < 1 + std::int64_t(random() % 2); ++level) {
      CellJob& job = jobs.emplace_back();
      job.id = std::uint32_t(jobs.size() - 1);
      job.lattice_min = {x * n, y * n, z + level * n};
      job.cell_voxels = cell_voxels;
      job.fingerprint = {job.id + 1, 7};
    }
  }
  return jobs;
}

Box3i64 box_of(const CellJob& job) { return Box3i64::cube(job.lattice_min, job.cell_voxels); }

bool overlap(const CellJob& a, const CellJob& b) { return box_of(a).overlaps(box_of(b)); }

int own_lod(const CellJob& overview) { return int(overview.first_lod + overview.copied_lods); }
int levels_of(const CellJob& overview) { return std::countr_zero(overview.cell_voxels) - own_lod(overview) - 2; }

TEST(Overviews, LeadToOneRootAndEachHasAllThatItsWindowOverlaps) {
  for (int round = 0; round < 60; ++round) {
    const test::RandomSeed seed(round);
    std::mt19937 random{unsigned(seed)};
    const std::uint32_t cell_voxels = 8u << random() % 9;
    std::vector<CellJob> jobs = scattered_cells(random, cell_voxels);
    const std::size_t cells = jobs.size();
    add_overviews(jobs);
    std::set<std::string> names;
    std::vector<std::set<std::uint32_t>> of_tier(32);
    for (std::size_t i = cells; i < jobs.size(); ++i) {
      const CellJob& p = jobs[i];
      ASSERT_EQ(p.id, i);
      EXPECT_TRUE(names.insert(p.name).second) << p.name;
      ASSERT_GE(levels_of(p), 1);
      ASSERT_LE(levels_of(p), max_levels_per_overview);
      for (const std::int64_t x : p.lattice_min) EXPECT_EQ(x % (std::int64_t(p.cell_voxels) / 8), 0);
      for (std::uint32_t j = 0; j < i; ++j) {
        const bool is_below = jobs[j].cell_voxels >> 3 == std::uint32_t(1) << (own_lod(p) - 1);
        const bool is_child = std::binary_search(p.children.begin(), p.children.end(), j);
        EXPECT_EQ(is_child, is_below && overlap(jobs[j], p)) << p.name << " and " << j;
      }
    }
    const CellJob& root = jobs.back();
    for (const CellJob& cell : std::span(jobs).first(cells)) EXPECT_EQ(hull(box_of(cell), box_of(root)), box_of(root));
    for (std::size_t i = cells; i + 1 < jobs.size(); ++i) EXPECT_LT(own_lod(jobs[i]), own_lod(root));
  }
}

TEST(Overviews, CopyWhatTheirChildrenHaveAndNeverTheirFinestLevel) {
  for (int round = 0; round < 40; ++round) {
    const test::RandomSeed seed(round);
    std::mt19937 random{unsigned(seed)};
    std::vector<CellJob> jobs = scattered_cells(random, 8u << random() % 9);
    const std::size_t cells = jobs.size();
    add_overviews(jobs);
    for (std::size_t i = cells; i < jobs.size(); ++i) {
      const CellJob& p = jobs[i];
      const bool of_cells = p.children.front() < cells;
      const std::uint32_t maximum = 1u << (of_cells ? overview_width_bits_of_cells : overview_width_bits_of_overviews);
      EXPECT_GE(p.first_lod, 1u) << p.name;
      EXPECT_LE(p.cell_voxels >> p.first_lod, std::max(maximum, 8u << levels_of(p))) << p.name;
      for (const std::uint32_t child : p.children) {
        EXPECT_GT(p.first_lod, jobs[child].first_lod) << p.name << " copies of " << jobs[child].name;
        EXPECT_EQ(jobs[child].cell_voxels >> (own_lod(p) - 1), 8u) << p.name << " follows " << jobs[child].name;
        EXPECT_EQ(jobs[child].kept_lod, p.first_lod) << "what " << p.name << " copies is kept in memory";
      }
    }
  }
}

TEST(Overviews, OfCellsOf64AreAsWideAsPicturesNeedThem) {
  std::vector<CellJob> jobs;
  for (std::uint32_t i = 0; i < 64 * 64 * 4; ++i) {
    jobs.emplace_back();
    jobs[i].id = i, jobs[i].cell_voxels = 64, jobs[i].fingerprint = {i, 1};
    jobs[i].lattice_min = {64 * std::int64_t(i % 128), 64 * std::int64_t(i / 128), 0};
  }
  add_overviews(jobs);
  const CellJob& first = jobs[64 * 64 * 4];
  EXPECT_EQ(first.first_lod, 1u);
  EXPECT_EQ(first.copied_lods, 3u);
  EXPECT_EQ(first.name, "p4_0_0_0") << "named by its own levels";
  EXPECT_EQ(jobs.back().cell_voxels >> jobs.back().first_lod, 1024u);
  EXPECT_EQ(jobs[0].kept_lod, first.first_lod) << "what its overview copies is kept in memory";
  EXPECT_EQ(jobs.back().kept_lod, 0u) << "the root has no overview";
}

TEST(Overviews, OfOneCellAreNone) {
  std::vector<CellJob> jobs(1);
  jobs[0].cell_voxels = 64;
  add_overviews(jobs);
  EXPECT_EQ(jobs.size(), 1u);
}

TEST(Overviews, AreAFewOfAHundredCellsAndNewWhereAChildIs) {
  std::vector<CellJob> jobs;
  for (std::uint32_t i = 0; i < 64 * 64; ++i) {
    jobs.emplace_back();
    jobs[i].id = i, jobs[i].cell_voxels = 64, jobs[i].fingerprint = {i, 1};
    jobs[i].lattice_min = {64 * std::int64_t(i % 64), 64 * std::int64_t(i / 64), 0};
  }
  std::vector<CellJob> changed = jobs;
  changed[77].fingerprint = {77, 2};
  add_overviews(jobs);
  add_overviews(changed);
  EXPECT_EQ(jobs.size(), 64u * 64u + 64u + 1u);
  std::size_t others = 0;
  for (std::size_t i = 64 * 64; i < jobs.size(); ++i) others += jobs[i].fingerprint != changed[i].fingerprint;
  EXPECT_EQ(others, 2u);
}

class FourCells : public testing::Test {
 protected:
  FourCells() : jobs_(4) {
    for (std::uint32_t i = 0; i < 4; ++i) {
      jobs_[i].id = i, jobs_[i].name = "c_" + std::to_string(i), jobs_[i].cell_voxels = 64;
      jobs_[i].fingerprint = {i, 1}, jobs_[i].lattice_min = {1024 * std::int64_t(i / 2) + 64 * (i % 2), 0, 0};
    }
    add_overviews(jobs_);  // jobs 4 and 5 are overviews of two cells each, job 6 of both overviews
  }
  static CellReport report(const CellJob& job, CellOutcome outcome) {
    CellReport r;
    r.id = job.id, r.outcome = outcome, r.cell.fingerprint = job.fingerprint;
    return r;
  }

  std::vector<CellJob> jobs_;
};

TEST_F(FourCells, HaveOverviewsThatAreOrderedWithTheShardsThatThereAre) {
  ASSERT_EQ(jobs_.size(), 7u);
  OverviewJobs orders(jobs_);
  orders.is_done(report(jobs_[0], CellOutcome::baked));
  orders.is_done(report(jobs_[1], CellOutcome::empty));
  EXPECT_EQ(orders.order(0).fingerprint, jobs_[0].fingerprint);
  const CellJob whole = orders.order(4);
  EXPECT_EQ(whole.fingerprint, jobs_[4].fingerprint);
  EXPECT_THAT(whole.child_files, ElementsAre(shard_path(jobs_[0]).generic_string()));
}

TEST_F(FourCells, HaveOverviewsOfOtherNamesWhereACellIsLost) {
  OverviewJobs orders(jobs_);
  for (const std::uint32_t cell : {0u, 1u, 3u}) orders.is_done(report(jobs_[cell], CellOutcome::baked));
  orders.is_done(report(orders.order(4), CellOutcome::baked));
  const CellJob holed = orders.order(5);
  EXPECT_NE(holed.fingerprint, jobs_[5].fingerprint);
  EXPECT_THAT(holed.child_files, ElementsAre(shard_path(jobs_[3]).generic_string()));
  EXPECT_FALSE(is_made_of_all(report(holed, CellOutcome::baked), jobs_[5]));
  orders.is_done(report(holed, CellOutcome::baked));
  const CellJob root = orders.order(6);
  EXPECT_NE(root.fingerprint, jobs_[6].fingerprint);
  EXPECT_THAT(root.child_files, ElementsAre(shard_path(jobs_[4]).generic_string(), shard_path(holed).generic_string()));
}

TEST_F(FourCells, MakeTheirOverviewReadyForAWorkerThatFinishedOne) {
  OverviewQueue queue(jobs_);
  EXPECT_EQ(queue.waiting(), 3u);
  EXPECT_FALSE(queue.choose(0));
  queue.settled(0, 1);
  queue.settled(1, 2);
  queue.settled(3, 1);
  queue.settled(2, 3);
  EXPECT_EQ(queue.waiting(), 1u);
  EXPECT_EQ(queue.choose(2), 4u);
  EXPECT_EQ(queue.choose(3), 5u);
  EXPECT_FALSE(queue.choose(1)) << "the children are in the memory of others";
  queue.forget(2);
  EXPECT_EQ(queue.choose(1), 4u);
  queue.take(4);
  EXPECT_EQ(queue.choose(3), 5u);
  queue.take(6);  // baked by an earlier run
  EXPECT_EQ(queue.waiting(), 0u);
}

TEST(OverviewQueue, IsReadyForTheWorkerThatFinishedMoreThanHalfInAnyOrder) {
  std::vector<CellJob> jobs(12);
  for (std::uint32_t i = 0; i < jobs.size(); ++i) jobs[i].id = i;
  jobs[11].first_lod = 1;
  for (std::uint32_t child = 0; child < 11; ++child) jobs[11].children.push_back(child);
  std::vector<std::optional<int>> finished_by{5, 5, 5, 5, 5, 5, 7, 8, 7, std::nullopt, 9};
  for (int round = 0; round < 100; ++round) {
    const test::RandomSeed seed(round);
    std::mt19937 random{unsigned(seed)};
    std::shuffle(finished_by.begin(), finished_by.end(), random);
    OverviewQueue queue(jobs);
    for (std::uint32_t child = 0; child < 11; ++child) queue.settled(child, finished_by[child]);
    EXPECT_EQ(queue.choose(5), 11u);
    EXPECT_FALSE(queue.choose(7));
    queue.forget(5);
    EXPECT_EQ(queue.choose(7), 11u);
  }
}

TEST(OverviewQueue, IsReadyForAllIfNoWorkerOfThisRunFinishedAChild) {
  std::vector<CellJob> jobs(3);
  for (std::uint32_t i = 0; i < jobs.size(); ++i) jobs[i].id = i;
  jobs[2].first_lod = 1, jobs[2].children = {0, 1};
  OverviewQueue queue(jobs);
  queue.settled(0, std::nullopt);
  queue.settled(1, std::nullopt);
  EXPECT_EQ(queue.choose(4), 2u);
}

}  // namespace
}  // namespace gigabake
