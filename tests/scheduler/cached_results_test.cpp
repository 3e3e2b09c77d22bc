#include "scheduler/journal/cached_results.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "made_bake.h"
#include "scheduler/journal/journal.h"

namespace gigabake {
namespace {

class PriorTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Journal journal(folder / "journal", {});
    for (const CellJob& job : plan.jobs)
      journal.append(job, job.id == 3 ? empty_cell(job) : bake_cell_of_text(job, folder.path()));
  }
  CachedResults prior(const BakePlan& asked) const {
    return find_cached(asked, read_journal(folder / "journal"), folder.path(), 2);
  }
  std::filesystem::path shard(std::size_t job) const { return folder.path() / shard_path(plan.jobs[job]); }

  TestFolder folder;
  BakePlan plan = made_plan(6);
};

TEST_F(PriorTest, AnUnchangedBakeIsDoneAndItsReportsAreTakenOver) {
  const CachedResults all = prior(plan);
  EXPECT_EQ(all.reasons, std::vector<CacheStatus>(6, CacheStatus::unchanged));
  ASSERT_EQ(all.done.size(), 6u);
  for (std::uint32_t i = 0; i < 6; ++i) EXPECT_EQ(all.done[i].id, i);
  EXPECT_EQ(all.done[3].outcome, CellOutcome::empty);
  EXPECT_EQ(all.done[4].cell.name, "c_4_0_0");
  EXPECT_EQ(all.done[4].read_s, 0);
}

TEST_F(PriorTest, AReportGetsTheIdOfItsJobInThisPlan) {
  BakePlan smaller;
  smaller.jobs = {plan.jobs[5], plan.jobs[3]};
  smaller.jobs[0].id = 0, smaller.jobs[1].id = 1;
  const CachedResults two = prior(smaller);
  ASSERT_EQ(two.done.size(), 2u);
  EXPECT_EQ(two.done[0].id, 0u);
  EXPECT_EQ(two.done[0].cell.name, "c_5_0_0");
  EXPECT_EQ(two.done[1].id, 1u);
}

TEST_F(PriorTest, NamesWhyACellIsToBeBaked) {
  BakePlan next = made_plan(8);
  next.jobs[1].fingerprint = {2, 99};
  std::filesystem::remove(shard(2));
  const CachedResults r = prior(next);
  EXPECT_EQ(r.reasons[0], CacheStatus::unchanged);
  EXPECT_EQ(r.reasons[1], CacheStatus::inputs_changed);
  EXPECT_EQ(r.reasons[2], CacheStatus::shard_missing);
  EXPECT_EQ(r.reasons[7], CacheStatus::new_cell);
  EXPECT_EQ(r.counts(), (std::array<std::size_t, cache_statuses>{4, 0, 1, 1, 2}));
  EXPECT_EQ(r.done.size(), 4u);
}

TEST_F(PriorTest, AShardThatWasTouchedInAnyWayIsChecked) {
  const std::string content = read_text(shard(0));
  write_text(shard(0), content);                                   // the same bytes again
  write_text(shard(1), read_text(shard(1)) + "x");                 // another size
  std::filesystem::copy_file(shard(2), folder / "copy");           // another file of the same bytes
  std::filesystem::rename(folder / "copy", shard(2));              //
  const timespec then[2] = {{1000, 0}, {1000, 0}};                 // only the mtime
  ASSERT_EQ(::utimensat(AT_FDCWD, shard(4).c_str(), then, 0), 0);  //
  std::filesystem::remove(shard(5));
  std::filesystem::create_directory(shard(5));  // a folder instead of a file
  const CachedResults r = prior(plan);
  for (const int job : {0, 1, 2, 4}) EXPECT_EQ(r.reasons[std::size_t(job)], CacheStatus::to_be_checked) << job;
  EXPECT_EQ(r.reasons[5], CacheStatus::shard_missing);
  EXPECT_EQ(r.done.size(), 1u);
}

TEST_F(PriorTest, AnEditThatSetsSizeAndTimeBackIsChecked) {
  struct stat before {};
  ASSERT_EQ(::stat(shard(0).c_str(), &before), 0);
  std::string content = read_text(shard(0));
  content[0] ^= 1;
  write_text(shard(0), content);
  const timespec times[2] = {before.st_atim, before.st_mtim};
  ASSERT_EQ(::utimensat(AT_FDCWD, shard(0).c_str(), times, 0), 0);
  EXPECT_EQ(prior(plan).reasons[0], CacheStatus::to_be_checked);
}

TEST_F(PriorTest, WithoutItsJournalEveryShardIsCheckedAndEmptyCellsAreBaked) {
  std::filesystem::remove(folder / "journal");
  const CachedResults r = prior(plan);
  EXPECT_EQ(r.reasons[0], CacheStatus::to_be_checked);
  EXPECT_EQ(r.reasons[3], CacheStatus::new_cell);
  EXPECT_TRUE(r.done.empty());
}

TEST_F(PriorTest, AReportOfAnotherCellIsNotTrusted) {
  {
    Journal journal(folder / "journal", read_journal(folder / "journal"));
    journal.append(plan.jobs[0], bake_cell_of_text(plan.jobs[1], folder.path()));
  }
  EXPECT_EQ(prior(plan).reasons[0], CacheStatus::to_be_checked);
}

TEST_F(PriorTest, AFolderThatIsNotThereHasNothing) {
  const CachedResults r = find_cached(plan, read_journal(folder / "absent/journal"), folder / "absent", 2);
  EXPECT_EQ(r.reasons, std::vector<CacheStatus>(6, CacheStatus::new_cell));
}

}  // namespace
}  // namespace gigabake
