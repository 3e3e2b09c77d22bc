#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>

#include "scheduler/queue/schedule.h"
#include "tests/scheduler/made_jobs.h"

namespace gigabake {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Assignment take(Schedule& schedule, int worker, double now_s = 0) {
  const auto a = schedule.next(worker, now_s);
  EXPECT_TRUE(a) << "nothing for worker " << worker;
  return a.value_or(Assignment{});
}

TEST(ScheduleFaults, SetACellAsideAfterThreeStrikesEachAtAnotherWorker) {
  const std::vector<CellJob> jobs = equal_jobs(1);
  Schedule schedule(jobs, {});
  for (int worker = 0; worker < 5; ++worker) schedule.heard_from(worker, 0);
  std::set<int> tried_at;
  for (std::uint32_t attempt = 1; attempt <= 3; ++attempt)
    for (int worker = 0; worker < 5; ++worker)
      if (const auto a = schedule.next(worker, 0)) {
        EXPECT_EQ(a->attempt, attempt);
        EXPECT_TRUE(tried_at.insert(worker).second);
        EXPECT_EQ(schedule.failed(worker, a->job, a->attempt, "error " + std::to_string(attempt), 0),
                  Verdict::accepted);
        break;
      }
  EXPECT_EQ(tried_at.size(), 3u);
  EXPECT_TRUE(schedule.is_over());
  EXPECT_EQ(schedule.counts(), (JobCounts{0, 0, 0, 1, 0}));
  EXPECT_EQ(schedule.error(0), "error 3 (tried 3 times)");
  EXPECT_THAT(schedule.take_quarantined(), ElementsAre(0));
  EXPECT_THAT(schedule.take_quarantined(), IsEmpty());
}

TEST(ScheduleFaults, TryAgainAtTheSameWorkerWhereItIsTheOnlyOneLeft) {
  const std::vector<CellJob> jobs = equal_jobs(1);
  Schedule schedule(jobs, {});
  schedule.heard_from(1, 0);
  const Assignment a = take(schedule, 0);
  schedule.failed(0, a.job, a.attempt, "no", 0);
  EXPECT_FALSE(schedule.next(0, 0)) << "worker 1 could have it";
  schedule.heard_from(0, 100);
  EXPECT_THAT(schedule.silent(100), ElementsAre(1));
  EXPECT_EQ(take(schedule, 0, 100), (Assignment{0, 2, false}));
}

TEST(ScheduleFaults, TryWhatFailedBeforeWhatIsNew) {
  const std::vector<CellJob> jobs = equal_jobs(100);
  Schedule schedule(jobs, {});
  schedule.heard_from(1, 0);
  const Assignment a = take(schedule, 0);
  schedule.failed(0, a.job, a.attempt, "no", 0);
  EXPECT_NE(take(schedule, 0).job, a.job);
  EXPECT_EQ(take(schedule, 1), (Assignment{a.job, 2, false}));
}

TEST(ScheduleFaults, KeepWorkersSuppliedWithWhatFailedElsewhere) {
  const std::vector<CellJob> jobs = equal_jobs(10);
  Schedule schedule(jobs, {});
  schedule.heard_from(1, 0);
  for (int i = 0; i < 9; ++i) schedule.failed(0, take(schedule, 0).job, 1, "no", 0);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(take(schedule, 1).attempt, 2u);
}

TEST(ScheduleFaults, BlameNobodyButSuspectAllWhenAProcessDiesWithSeveralCells) {
  const std::vector<CellJob> jobs = equal_jobs(50);
  Schedule schedule(jobs, {});
  schedule.heard_from(1, 0);
  std::set<std::uint32_t> suspects, tried;
  for (int i = 0; i < 3; ++i) suspects.insert(take(schedule, 0).job);
  take(schedule, 1);
  schedule.process_died(0, "killed by signal 9", 1);
  EXPECT_EQ(schedule.out(), 1u);
  EXPECT_FALSE(take(schedule, 1, 1).alone) << "the worker has cells in flight";
  for (int i = 0; i < 3; ++i) {
    const Assignment a = take(schedule, 0, 1);
    EXPECT_TRUE(a.alone);
    EXPECT_EQ(schedule.error(a.job), "");
    EXPECT_FALSE(schedule.next(0, 1)) << "no other cell during an isolated retry";
    tried.insert(a.job);
    EXPECT_EQ(schedule.finished(0, a.job, a.attempt, 2), Verdict::accepted);
  }
  EXPECT_EQ(tried, suspects);
  EXPECT_FALSE(take(schedule, 0, 2).alone);
}

TEST(ScheduleFaults, StrikeACellThatWasAloneWhenItsProcessDied) {
  const std::vector<CellJob> jobs = equal_jobs(2);
  Schedule schedule(jobs, {});
  for (int worker = 0; worker < 4; ++worker) schedule.heard_from(worker, 0);
  const std::uint32_t job = take(schedule, 0).job;
  schedule.process_died(0, "killed by signal 11", 0);
  for (const int worker : {1, 2}) {
    EXPECT_EQ(take(schedule, worker).job, job);
    EXPECT_FALSE(schedule.next(worker, 0)) << "the other cell waits for the isolated retry";
    schedule.process_died(worker, "killed by signal 11", 0);
  }
  EXPECT_EQ(schedule.state(job), JobState::failed);
  EXPECT_EQ(schedule.error(job), "killed by signal 11 (tried 3 times)");
  EXPECT_EQ(schedule.counts(), (JobCounts{1, 0, 0, 1, 0}));
}

TEST(ScheduleFaults, LetOneWorkerRunDryForASuspectThatWaitsTooLong) {
  const std::vector<CellJob> jobs = equal_jobs(200);
  Schedule schedule(jobs, {});
  take(schedule, 0), take(schedule, 0);
  std::vector<Assignment> hand;
  for (int i = 0; i < 3; ++i) hand.push_back(take(schedule, 1));
  schedule.process_died(0, "ended for good", 0);
  schedule.finished(1, hand[0].job, 1, 30);
  EXPECT_FALSE(take(schedule, 1, 30).alone) << "no reason to stall yet";
  schedule.finished(1, hand[1].job, 1, 61);
  EXPECT_FALSE(schedule.next(1, 61)) << "the worker finishes its other cells first";
  EXPECT_TRUE(schedule.next(2, 61)->alone) << "an idle worker takes it at once";
  EXPECT_TRUE(schedule.next(3, 61)->alone) << "so does another idle worker";
  EXPECT_TRUE(schedule.next(1, 61)) << "no isolated retry is left";
}

TEST(ScheduleFaults, TakeASilentWorkersCellsAwayWithoutBlame) {
  const std::vector<CellJob> jobs = equal_jobs(60);
  Schedule schedule(jobs, {});
  const Assignment a = take(schedule, 0);
  schedule.heard_from(1, 50);
  EXPECT_THAT(schedule.silent(60), IsEmpty());
  EXPECT_THAT(schedule.silent(61), ElementsAre(0));
  EXPECT_THAT(schedule.silent(62), IsEmpty()) << "said once";
  EXPECT_EQ(schedule.out(), 0u);
  EXPECT_FALSE(schedule.next(0, 62));
  EXPECT_EQ(take(schedule, 1, 62), (Assignment{a.job, 2, false}));
  EXPECT_EQ(schedule.error(a.job), "");
}

TEST(ScheduleFaults, WelcomeALostWorkerBackButNotItsLateResults) {
  const std::vector<CellJob> jobs = equal_jobs(60);
  Schedule schedule(jobs, {});
  const Assignment a = take(schedule, 0), b = take(schedule, 0);
  schedule.heard_from(1, 61);
  schedule.silent(61);
  const Assignment again = take(schedule, 1, 61);
  const Assignment &given = again.job == a.job ? a : b, &kept = again.job == a.job ? b : a;
  const JobCounts before = schedule.counts();
  EXPECT_EQ(schedule.finished(0, given.job, given.attempt, 62), Verdict::stale);
  EXPECT_EQ(schedule.failed(0, kept.job, kept.attempt, "late", 62), Verdict::stale);
  EXPECT_EQ(schedule.counts(), before);
  EXPECT_EQ(schedule.finished(0, kept.job, kept.attempt, 62), Verdict::accepted) << "no other worker has the cell";
  EXPECT_EQ(schedule.state(kept.job), JobState::done);
  EXPECT_EQ(schedule.finished(1, again.job, again.attempt, 63), Verdict::accepted);
  EXPECT_TRUE(schedule.next(0, 63));
}

TEST(ScheduleFaults, SuspectACellThatWasLostTwiceAndBlameItWhenItIsLostAlone) {
  const std::vector<CellJob> jobs = equal_jobs(1);
  Schedule schedule(jobs, {});
  double now_s = 0;
  for (std::uint32_t attempt = 1; attempt <= 5; ++attempt) {
    const int worker = int(attempt);
    schedule.heard_from(9, now_s);
    EXPECT_EQ(take(schedule, worker, now_s), (Assignment{0, attempt, attempt > 2}));
    now_s += 61;
    schedule.heard_from(9, now_s);
    EXPECT_THAT(schedule.silent(now_s), ElementsAre(worker));
  }
  EXPECT_EQ(schedule.state(0), JobState::failed);
  EXPECT_EQ(schedule.error(0), "worker 5 stopped sending messages (tried 3 times)");
}

TEST(ScheduleFaults, EndTheBakeWhenNobodyIsLeft) {
  const std::vector<CellJob> jobs = equal_jobs(10);
  Schedule schedule(jobs, {});
  const Assignment a = take(schedule, 0);
  EXPECT_THAT(schedule.silent(61), ElementsAre(0));
  EXPECT_TRUE(schedule.is_over());
  EXPECT_EQ(schedule.counts(), (JobCounts{0, 0, 0, 0, 10}));
  EXPECT_EQ(schedule.finished(0, a.job, a.attempt, 62), Verdict::accepted) << "late, but good";
  EXPECT_EQ(schedule.counts(), (JobCounts{0, 0, 1, 0, 9}));
}

}  // namespace
}  // namespace gigabake
