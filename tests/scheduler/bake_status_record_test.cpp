#include "scheduler/status/bake_status_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>

#include "scheduler/plan/estimate.h"
#include "scheduler/queue/schedule.h"
#include "tests/scheduler/made_jobs.h"

namespace gigabake {
namespace {

constexpr double start_s = 1700000000;

std::vector<CellJob> named_jobs(std::uint32_t number) {
  std::vector<CellJob> jobs = equal_jobs(number);
  for (CellJob& job : jobs) job.name = "c_" + std::to_string(job.id) + "_0_0";
  return jobs;
}

CellReport baked(std::uint32_t job, double seconds = 3) {
  CellReport r;
  r.id = job;
  r.outcome = CellOutcome::baked;
  r.cell.voxels = {800, 200};
  r.cell.bytes = 5000;
  r.read_s = 0.25 * seconds;
  r.kernel_s = 0.25 * seconds;
  r.write_s = 0.5 * seconds;
  return r;
}

struct Bake {
  explicit Bake(std::uint32_t cells, std::vector<double> costs = {}) : jobs(named_jobs(cells)) {
    record.planned(jobs, costs.empty() ? std::vector<double>(cells, 1) : costs, start_s);
  }
  std::vector<CellJob> jobs;
  BakeStatusRecord record{{"/out", "node1", 77, 4}, start_s - 10};
};

std::uint64_t sum(const CellTally& c) {
  return c.taken_over + c.pending + c.running + c.done + c.empty + c.quarantined;
}

TEST(BakeStatusRecord, KnowsWhoseBakeItIsAndHowFarTheScanIs) {
  BakeStatusRecord record({"/out", "node1", 77, 4}, start_s);
  record.scanned(3, 8);
  const BakeStatus s = record.at(start_s + 2);
  EXPECT_EQ(s.state, BakeState::scanning);
  EXPECT_EQ(s.out + " " + s.host, "/out node1");
  EXPECT_EQ(s.pid, 77);
  EXPECT_EQ(s.ranks, 4);
  EXPECT_EQ(s.tiles_scanned, 3u);
  EXPECT_EQ(s.tiles, 8u);
  EXPECT_EQ(s.started_s, start_s);
  EXPECT_EQ(s.updated_s, start_s + 2);
  EXPECT_FALSE(s.left_s);
}

TEST(BakeStatusRecord, FollowsACellFromHandToHand) {
  Bake b(5);
  b.record.worker_joined(0, "node1", start_s);
  b.record.worker_joined(2, "node2", start_s);
  b.record.already_done(4);
  b.record.handed_out(0, 0, start_s + 1);
  b.record.handed_out(1, 2, start_s + 2);
  b.record.handed_out(2, 2, start_s + 3);
  BakeStatus s = b.record.at(start_s + 4);
  EXPECT_EQ(s.cells, (CellTally{5, 1, 1, 3, 0, 0, 0, 0}));
  ASSERT_EQ(s.workers.size(), 2u);
  EXPECT_EQ(s.workers[1], (WorkerStatus{2, "node2", false, start_s + 3, {"c_1_0_0", "c_2_0_0"}}));

  b.record.cell_done(baked(1), start_s + 5);
  b.record.attempt_failed(2, start_s + 6);
  b.record.handed_out(2, 0, start_s + 7);
  s = b.record.at(start_s + 8);
  EXPECT_EQ(s.cells, (CellTally{5, 1, 1, 2, 1, 0, 0, 1}));
  EXPECT_THAT(s.workers[0].cells, testing::ElementsAre("c_0_0_0", "c_2_0_0"));
  EXPECT_THAT(s.workers[1].cells, testing::IsEmpty());
  EXPECT_EQ(s.workers[1].since_s, start_s + 6);
  EXPECT_EQ(s.voxels, 1000u);
  EXPECT_EQ(s.bytes, 5000u);
  EXPECT_EQ(s.write_s, 1.5);
}

TEST(BakeStatusRecord, OfEventsIsThatOfItsFunctions) {
  BakePlan plan;
  plan.jobs = named_jobs(4);
  plan.losses = {{"tile a.glb", "not JSON"}};
  std::vector<CellReport> reused(1);
  reused[0].id = 3;
  const CellReport done = baked(0);
  CellReport failed;
  failed.id = 1, failed.error = "died";
  BakeStatusRecord by_events({"/out", "node1", 77, 4}, start_s), by_calls = by_events;
  by_events.add(TilesScanned{2, 2}, start_s);
  by_events.add(DispatchBegan{plan, reused}, start_s + 1);
  by_events.add(WorkerJoined{1, "node2"}, start_s + 1);
  for (const std::uint32_t job : {0u, 1u, 2u}) by_events.add(JobDispatched{job, int(job % 2)}, start_s + 2);
  by_events.add(JobFinished{done, plan.jobs[0]}, start_s + 3);
  by_events.add(AttemptFailed{1}, start_s + 4);
  by_events.add(JobQuarantined{failed, plan.jobs[1]}, start_s + 4);
  by_events.add(ProcessDied{0, "killed"}, start_s + 5);
  by_events.add(WorkerLost{1}, start_s + 6);
  by_events.add(StateEntered{BakeState::draining}, start_s + 7);
  by_events.add(BakeAlive{}, start_s + 8);
  by_events.add(InfoLine{"a line"}, start_s + 8);

  by_calls.scanned(2, 2);
  by_calls.lost("tile a.glb", "not JSON");
  std::vector<double> costs;
  for (const CellJob& job : plan.jobs) costs.push_back(double(cell_cost(job)));
  by_calls.planned(plan.jobs, costs, start_s + 1);
  by_calls.already_done(3);
  by_calls.worker_joined(1, "node2", start_s + 1);
  for (const std::uint32_t job : {0u, 1u, 2u}) by_calls.handed_out(job, int(job % 2), start_s + 2);
  by_calls.cell_done(done, start_s + 3);
  by_calls.attempt_failed(1, start_s + 4);
  by_calls.quarantined(1, "died", start_s + 4);
  by_calls.process_died(0, start_s + 5);
  by_calls.worker_lost(1, start_s + 6);
  by_calls.enter(BakeState::draining);
  EXPECT_EQ(by_events.at(start_s + 9), by_calls.at(start_s + 9));
}

TEST(BakeEvents, WarnOfProblemsAndOfNothingElse) {
  BakePlan plan;
  plan.jobs = named_jobs(1);
  CellReport clean, noted;
  noted.note = "2 triangles were dropped";
  const CellJob& job = plan.jobs[0];
  EXPECT_EQ(warning_of(JobFinished{noted, job}), "cell " + job.name + ": 2 triangles were dropped");
  EXPECT_EQ(warning_of(ProcessDied{2, "out of memory"}), "the bake process of rank 2 is started again: out of memory");
  EXPECT_EQ(warning_of(WorkerLost{3}), "no message from rank 3; other ranks bake its cells");
  EXPECT_EQ(warning_of(WarningLine{"a line"}), "a line");
  EXPECT_TRUE(warning_of(StateEntered{BakeState::draining}));
  for (const BakeEvent& event : {BakeEvent(JobFinished{clean, job}), BakeEvent(JobQuarantined{clean, job}),
                                 BakeEvent(JobsPlanned{plan}), BakeEvent(TilesScanned{1, 2}), BakeEvent(BakeAlive{}),
                                 BakeEvent(InfoLine{"a line"}), BakeEvent(StateEntered{BakeState::publishing})})
    EXPECT_FALSE(warning_of(event)) << event.index();
}

TEST(BakeStatusRecord, ListsWhatWillBeMissing) {
  Bake b(40);
  b.record.lost("tile a.glb", "not JSON");
  for (std::uint32_t job = 0; job < 30; ++job) {
    b.record.handed_out(job, 0, start_s);
    b.record.attempt_failed(job, start_s);
    b.record.quarantined(job, "died", start_s);
    b.record.quarantined(job, "died twice", start_s);
  }
  const BakeStatus s = b.record.at(start_s + 1);
  EXPECT_EQ(s.failures, 31u);
  EXPECT_EQ(s.cells.quarantined, 30u);
  EXPECT_EQ(s.cells.failed_attempts, 30u);
  ASSERT_EQ(s.first_failures.size(), max_failures_listed);
  EXPECT_EQ(s.first_failures[0], (BakeFailure{"tile a.glb", "not JSON"}));
  EXPECT_EQ(s.first_failures[1], (BakeFailure{"cell c_0_0_0", "died"}));
}

TEST(BakeStatusRecord, PutsCellsBackWhenAProcessDiesOrAWorkerIsLost) {
  Bake b(6);
  for (std::uint32_t job = 0; job < 6; ++job) b.record.handed_out(job, int(job / 3), start_s);
  b.record.process_died(0, start_s + 1);
  b.record.worker_lost(1, start_s + 2);
  BakeStatus s = b.record.at(start_s + 3);
  EXPECT_EQ(s.cells, (CellTally{6, 0, 6, 0, 0, 0, 0, 0}));
  EXPECT_EQ(s.process_restarts, 1u);
  EXPECT_EQ(s.workers_lost, 1u);
  EXPECT_FALSE(s.workers[0].lost);
  EXPECT_TRUE(s.workers[1].lost);

  b.record.cell_done(baked(5), start_s + 4);  // a success that is reported late
  b.record.worker_joined(1, "node9", start_s + 5);
  s = b.record.at(start_s + 6);
  EXPECT_EQ(s.cells.done, 1u);
  EXPECT_EQ(s.slowest.at(0), (SlowCell{"c_5_0_0", 3, {}}));
  EXPECT_FALSE(s.workers[1].lost);
  EXPECT_EQ(s.workers[1].host, "node9");
}

TEST(BakeStatusRecord, KeepsTheSlowestCells) {
  Bake b(100);
  std::vector<std::uint32_t> order(100);
  for (std::uint32_t i = 0; i < 100; ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  for (const std::uint32_t job : order) {
    b.record.handed_out(job, int(job % 4), start_s);
    b.record.cell_done(baked(job, job), start_s);
  }
  const BakeStatus s = b.record.at(start_s + 1);
  ASSERT_EQ(s.slowest.size(), max_slow_cells);
  for (std::uint32_t i = 0; i < max_slow_cells; ++i)
    EXPECT_EQ(s.slowest[i], (SlowCell{"c_" + std::to_string(99 - i) + "_0_0", double(99 - i), int((99 - i) % 4)}));
}

TEST(BakeStatusRecord, EstimatesTheTimeLeftFromCostAndNotFromCells) {
  Bake b(4, {70, 10, 10, 10});
  for (std::uint32_t job = 0; job < 4; ++job) b.record.handed_out(job, 0, start_s);
  EXPECT_FALSE(b.record.at(start_s + 7).left_s) << "no estimate before the first cell";
  b.record.cell_done(baked(0), start_s + 7);
  EXPECT_NEAR(*b.record.at(start_s + 7).left_s, 3, 1e-9);
  b.record.cell_done(baked(1), start_s + 8);
  EXPECT_NEAR(*b.record.at(start_s + 8).left_s, 2, 1e-9);
  b.record.quarantined(2, "died", start_s + 8);
  EXPECT_NEAR(*b.record.at(start_s + 8).left_s, 1, 1e-9);
  b.record.cell_done(baked(3), start_s + 9);
  EXPECT_EQ(b.record.at(start_s + 9).left_s, 0);
}

TEST(BakeStatusRecord, TakesWorkOfAnEarlierRunForNoWorkOfThisOne) {
  Bake b(4, {70, 10, 10, 10});
  b.record.already_done(0);
  for (std::uint32_t job = 1; job < 4; ++job) b.record.handed_out(job, 0, start_s);
  b.record.cell_done(baked(1), start_s + 5);
  const BakeStatus s = b.record.at(start_s + 5);
  EXPECT_NEAR(*s.left_s, 10, 1e-9);
  EXPECT_NEAR(s.overall.cells_per_s, 0.2, 1e-9);
  EXPECT_EQ(s.cells.taken_over, 1u);
}

TEST(BakeStatusRecord, TellsTheLastMinuteFromTheWholeBake) {
  Bake b(1000);
  for (std::uint32_t job = 0; job < 100; ++job) b.record.cell_done(baked(job), start_s + 0.5 * job);
  EXPECT_NEAR(b.record.at(start_s + 50).recent.cells_per_s, 2, 1e-9)
      << "the rate of a young bake is over its whole duration";
  for (std::uint32_t job = 100; job < 160; ++job) b.record.cell_done(baked(job), start_s + 200 + 0.5 * (job - 100));
  const BakeStatus s = b.record.at(start_s + 230);
  EXPECT_NEAR(s.recent.cells_per_s, 1, 0.05);
  EXPECT_NEAR(s.recent.voxels_per_s, 1000, 50);
  EXPECT_NEAR(s.recent.bytes_per_s, 5000, 250);
  EXPECT_NEAR(s.overall.cells_per_s, 160 / 230., 1e-9);
  EXPECT_EQ(b.record.at(start_s + 1000).recent, Throughput{});
}

TEST(BakeStatusRecord, SurvivesAClockThatIsSetBack) {
  Bake b(10);
  b.record.cell_done(baked(0), start_s - 500);
  const BakeStatus s = b.record.at(start_s - 400);
  EXPECT_EQ(s.recent, Throughput{});
  EXPECT_EQ(s.overall, Throughput{});
  EXPECT_FALSE(s.left_s);
}

TEST(BakeStatusRecord, SaysHowItEnded) {
  Bake b(1);
  b.record.enter(BakeState::draining);
  EXPECT_FALSE(b.record.at(start_s + 1).left_s);
  b.record.fail("the disk is full");
  const BakeStatus s = b.record.at(start_s + 1);
  EXPECT_EQ(s.state, BakeState::failed);
  EXPECT_EQ(s.reason, "the disk is full");
  EXPECT_TRUE(is_over(s.state));
}

/// A bake by a Schedule whose workers fail, exit and stop sending, recorded as the master loop would record it.
class FaultyBake {
 public:
  explicit FaultyBake(unsigned seed) : random_(seed), jobs_(named_jobs(200)), schedule_(jobs_, {}) {
    for (CellJob& job : jobs_) job.triangles = 1 + random_() % 1000;
    record_.planned(jobs_, std::vector<double>(jobs_.size(), 1), start_s);
    for (int w = 0; w < workers; ++w) schedule_.heard_from(w, now_s_);
  }

  /// Expects the record and the Schedule to agree at every step.
  void run() {
    while (!schedule_.is_over()) {
      now_s_ += 0.1;
      for (int w = 0; w < workers; ++w) hand_out(w);
      something_happens();
      for (const std::uint32_t job : schedule_.take_quarantined())
        record_.quarantined(job, schedule_.error(job), now_s_);
      const CellTally c = record_.at(start_s + now_s_).cells;
      const JobCounts counts = schedule_.counts();
      ASSERT_EQ(sum(c), c.planned);
      ASSERT_EQ(c.running, counts.running);
      ASSERT_EQ(c.done + c.empty, counts.done);
      ASSERT_EQ(c.quarantined, counts.failed);
      ASSERT_EQ(c.pending, counts.pending);
    }
  }

 private:
  static constexpr int workers = 6;

  void hand_out(int w) {
    while (const auto a = schedule_.next(w, now_s_)) {
      record_.handed_out(a->job, w, now_s_);
      out_.push_back({w, *a});
    }
  }

  void something_happens() {
    if (out_.empty()) return;
    std::swap(out_[random_() % out_.size()], out_.back());
    const auto [w, a] = out_.back();
    const unsigned dice = random_() % 100;
    if (dice < 5) {
      schedule_.process_died(w, "killed", now_s_);
      record_.process_died(w, now_s_);
      std::erase_if(out_, [worker = w](const auto& o) { return o.first == worker; });
      return;
    }
    out_.pop_back();
    if (dice < 20) {
      if (schedule_.failed(w, a.job, a.attempt, "bad", now_s_) == Verdict::accepted)
        record_.attempt_failed(a.job, now_s_);
    } else if (schedule_.finished(w, a.job, a.attempt, now_s_) == Verdict::accepted) {
      record_.cell_done(baked(a.job), now_s_);
    }
  }

  std::mt19937 random_;
  std::vector<CellJob> jobs_;
  Schedule schedule_;
  BakeStatusRecord record_{{"/out", "node1", 1, workers}, start_s};
  std::vector<std::pair<int, Assignment>> out_;
  double now_s_ = 0;
};

TEST(BakeStatusRecord, AgreesWithTheScheduleWhateverGoesWrong) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    FaultyBake(seed).run();
  }
}

}  // namespace
}  // namespace gigabake
