#include "scheduler/queue/schedule.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>

#include "scheduler/plan/estimate.h"
#include "tests/scheduler/made_jobs.h"

namespace gigabake {
namespace {

constexpr unsigned schedule_seed = 79;

TEST(Schedule, BakesEveryCellOnceWhenNothingGoesWrong) {
  std::mt19937 random(schedule_seed);
  const std::vector<CellJob> jobs = made_jobs(500, random);
  Schedule schedule(jobs, {});
  std::vector<int> times(jobs.size());
  std::vector<std::pair<int, Assignment>> out;
  while (!schedule.is_over()) {
    for (int worker = 0; worker < 7; ++worker)
      while (const auto a = schedule.next(worker, 0)) out.push_back({worker, *a});
    ASSERT_EQ(schedule.out(), out.size());
    std::swap(out[random() % out.size()], out.back());
    const auto [worker, a] = out.back();
    out.pop_back();
    ++times[a.job];
    EXPECT_EQ(a.attempt, 1u);
    ASSERT_EQ(schedule.finished(worker, a.job, a.attempt, 0), Verdict::accepted) << "seed " << schedule_seed;
    ASSERT_EQ(schedule.finished(worker, a.job, a.attempt, 0), Verdict::stale) << "seed " << schedule_seed;
  }
  EXPECT_EQ(std::count(times.begin(), times.end(), 1), 500);
  EXPECT_EQ(schedule.counts(), (JobCounts{0, 0, 500, 0, 0}));
}

// 2026-11-22: a cell with invalid input was tried three times.
TEST(Schedule, SetsACellAsideAtOnceWhereAnotherTryIsUseless) {
  const std::vector<CellJob> jobs = equal_jobs(2);
  Schedule schedule(jobs, {});
  const auto first = schedule.next(0, 0);
  ASSERT_TRUE(first);
  EXPECT_EQ(schedule.failed(0, first->job, first->attempt, "bad input", 0, Retry::useless), Verdict::accepted);
  EXPECT_EQ(schedule.take_quarantined(), std::vector<std::uint32_t>{first->job});
  EXPECT_EQ(schedule.error(first->job), "bad input");
  EXPECT_EQ(schedule.state(first->job), JobState::failed);
}

TEST(Schedule, IsOverAtOnceWithoutCells) {
  const std::vector<CellJob> none;
  Schedule schedule(none, {});
  EXPECT_TRUE(schedule.is_over());
  EXPECT_FALSE(schedule.next(0, 0));
}

TEST(Schedule, LeavesOutWhatAnEarlierRunHasDone) {
  const std::vector<CellJob> jobs = equal_jobs(10);
  Schedule schedule(jobs, {});
  for (std::uint32_t job = 0; job < 9; ++job) schedule.already_done(job);
  schedule.already_done(0);
  EXPECT_EQ(schedule.counts(), (JobCounts{1, 0, 9, 0, 0}));
  EXPECT_EQ(schedule.next(0, 0), (Assignment{9, 1, false}));
  EXPECT_FALSE(schedule.next(1, 0));
}

TEST(Schedule, GivesAWorkerNoMoreThanItsSlots) {
  const std::vector<CellJob> jobs = equal_jobs(100);
  Schedule schedule(jobs, {3, 2, 60});
  schedule.heard_from(1, 0);
  EXPECT_TRUE(schedule.next(0, 0) && schedule.next(0, 0));
  EXPECT_FALSE(schedule.next(0, 0));
  EXPECT_TRUE(schedule.next(1, 0));
}

/// Dispatches all possible cells, worker by worker. Returns the number of cells that each worker then has.
std::vector<int> cells_in_hand(Schedule& schedule, int workers) {
  std::vector<int> hold(std::size_t(workers), 0);
  for (int worker = 0; worker < workers; ++worker) schedule.heard_from(worker, 0);
  for (int worker = 0; worker < workers; ++worker)
    while (schedule.next(worker, 0)) ++hold[std::size_t(worker)];
  return hold;
}

TEST(Schedule, SharesOutTheLastCellsSoThatNobodyHoardsWhileOthersIdle) {
  for (const std::uint32_t cells : {4u, 5u, 8u, 10u, 12u}) {
    const std::vector<CellJob> jobs = equal_jobs(cells);
    Schedule schedule(jobs, {});
    const std::vector<int> hold = cells_in_hand(schedule, 4);
    EXPECT_GE(*std::min_element(hold.begin(), hold.end()), 1) << cells << " cells";
  }
  const std::vector<CellJob> jobs = equal_jobs(100);
  Schedule schedule(jobs, {});
  EXPECT_EQ(cells_in_hand(schedule, 4), std::vector<int>(4, worker_slots));
}

TEST(Schedule, QueuesNothingBehindACellThatIsMoreThanAFairShare) {
  std::vector<CellJob> jobs = equal_jobs(20);
  jobs[7].triangles = 5000;
  Schedule schedule(jobs, {});
  schedule.heard_from(1, 0);
  EXPECT_EQ(schedule.next(0, 0)->job, 7u);
  EXPECT_FALSE(schedule.next(0, 0));
  EXPECT_TRUE(schedule.next(1, 0) && schedule.next(1, 0));
}

TEST(Schedule, KeepsASingleWorkerSuppliedToTheEnd) {
  const std::vector<CellJob> jobs = equal_jobs(3);
  Schedule schedule(jobs, {});
  EXPECT_TRUE(schedule.next(0, 0) && schedule.next(0, 0) && schedule.next(0, 0));
}

TEST(Schedule, DrainsWhenStoppedAndAbandonsTheRest) {
  const std::vector<CellJob> jobs = equal_jobs(10);
  Schedule schedule(jobs, {});
  const Assignment a = *schedule.next(0, 0), b = *schedule.next(0, 0);
  schedule.stop();
  EXPECT_FALSE(schedule.next(0, 0));
  EXPECT_FALSE(schedule.is_over());
  EXPECT_EQ(schedule.counts(), (JobCounts{0, 2, 0, 0, 8}));
  schedule.finished(0, a.job, a.attempt, 0);
  EXPECT_EQ(schedule.failed(0, b.job, b.attempt, "disk full", 0), Verdict::accepted);
  EXPECT_TRUE(schedule.is_over());
  EXPECT_EQ(schedule.counts(), (JobCounts{0, 0, 1, 0, 9}));
  EXPECT_EQ(schedule.state(b.job), JobState::abandoned);
  EXPECT_EQ(schedule.error(b.job), "disk full (tried once)");
}

TEST(Schedule, TakesReportsOfWhatItNeverHandedOutForStale) {
  const std::vector<CellJob> jobs = equal_jobs(5);
  Schedule schedule(jobs, {});
  const Assignment a = *schedule.next(0, 0);
  const JobCounts before = schedule.counts();
  for (const std::uint32_t job : {a.job, (a.job + 1) % 5, 5u, ~0u})
    for (const std::uint32_t attempt : {0u, 2u}) {
      EXPECT_EQ(schedule.finished(0, job, attempt, 0), Verdict::stale);
      EXPECT_EQ(schedule.failed(0, job, attempt, "no", 0), Verdict::stale);
    }
  EXPECT_EQ(schedule.finished(3, a.job, a.attempt, 0), Verdict::stale) << "another worker's cell";
  EXPECT_EQ(schedule.counts(), before);
}

}  // namespace
}  // namespace gigabake
