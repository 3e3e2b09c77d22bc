#include "cluster/dispatch/dispatch.h"

#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>

#include "cluster/bake/status_feed.h"
#include "core/base/error.h"
#include "scheduler/journal/journal.h"
#include "scripted_ranks.h"
#include "tests/scheduler/made_bake.h"
#include "tests/scheduler/made_jobs.h"

namespace gigabake {
namespace {

using Fate = ScriptedRanks::Fate;
using Delivery = ScriptedRanks::Delivery;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint64_t seed = 20261122;
constexpr std::uint32_t cells = 200;
constexpr double forever_s = 1e5;

/// A bake of cells without content, recorded by the real journal and status.
class Dispatch : public testing::Test {
 protected:
  Dispatch() {
    std::mt19937 random(seed);
    plan_.jobs = made_jobs(cells, random);
    for (CellJob& job : plan_.jobs) job.name = "c_" + std::to_string(job.id) + "_0_0", job.fingerprint = {job.id, 1};
    options_.heartbeat_timeout_s = 10;
  }

  DispatchResult run(ScriptedRanks& ranks, const std::vector<std::uint32_t>& already_done = {}) {
    std::filesystem::remove(folder_ / "journal");  // written by the previous round
    told_.clear(), notes_.clear();
    feed_.emplace(folder_.path(), ranks.ranks(), "", BakeListener());
    feed_->record().planned(plan_.jobs, std::vector<double>(cells, 1), unix_now_s());
    for (const std::uint32_t job : already_done) feed_->record().already_done(job);
    journal_.emplace(folder_ / "journal", JournalContent());
    const auto script = ranks.at;
    ranks.at = [script](double now_s) {
      if (now_s > forever_s) throw std::logic_error("the script never ends");
      script(now_s);
    };
    std::vector<CellReport> done;
    for (const std::uint32_t job : already_done) {
      done.emplace_back().id = job;
      done.back().outcome = CellOutcome::empty;
    }
    DispatchResult result =
        dispatch(ranks, plan_.jobs, done, options_, [this](const BakeEvent& event) { take(event); });
    journal_.reset();
    return result;
  }

  void take(const BakeEvent& event) {
    if (const auto* finished = std::get_if<JobFinished>(&event)) {
      journal_->append(finished->order, finished->report);
      told_.push_back(finished->report.id);
    }
    if (const auto* failed = std::get_if<JobQuarantined>(&event)) told_.push_back(failed->report.id);
    if (const auto warning = warning_of(event)) notes_.push_back(*warning);
    feed_->take(event);
  }

  /// Checks that every settled job was reported once, and that reports, log, journal and status agree.
  void expect_each_once(const DispatchResult& result, std::size_t taken_over = 0) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::set<std::uint32_t> seen;
    for (const CellReport& r : result.reports) EXPECT_TRUE(seen.insert(r.id).second) << r.id << " twice";
    const std::size_t done = result.counts.done - taken_over;
    EXPECT_EQ(result.counts.running + result.counts.pending, 0u);
    EXPECT_EQ(seen.size(), done + result.counts.failed);
    EXPECT_EQ(std::set(told_.begin(), told_.end()), seen);
    EXPECT_EQ(told_.size(), seen.size());
    EXPECT_EQ(read_journal(folder_ / "journal").records(), done);
    const CellTally tally = feed_->record().at(unix_now_s()).cells;
    EXPECT_EQ(tally.empty, done);
    EXPECT_EQ(tally.taken_over, taken_over);
    EXPECT_EQ(tally.quarantined, result.counts.failed);
  }

  static void expect_all_stopped(const ScriptedRanks& ranks) {
    for (int rank = 1; rank < ranks.ranks(); ++rank) EXPECT_TRUE(ranks.was_told_to_stop(rank)) << "rank " << rank;
  }

  const TestFolder folder_;
  BakePlan plan_;
  DispatchOptions options_;
  std::optional<StatusFeed> feed_;
  std::optional<Journal> journal_;
  std::vector<std::string> notes_;
  std::vector<std::uint32_t> told_;
};

class DispatchOnRanks : public Dispatch, public testing::WithParamInterface<int> {};

TEST_P(DispatchOnRanks, BakesEveryCellOnceAndTellsEveryRankThatItLivesAndWhenToStop) {
  ScriptedRanks ranks(GetParam(), seed);
  const DispatchResult result = run(ranks);
  expect_each_once(result);
  EXPECT_EQ(result.counts, (JobCounts{0, 0, cells, 0, 0}));
  EXPECT_EQ(ranks.orders(), cells);
  EXPECT_THAT(result.lost_ranks, IsEmpty());
  EXPECT_FALSE(result.is_drained);
  EXPECT_EQ(result.peak_bytes, std::uint64_t(GetParam() - 1) << 20);
  EXPECT_THAT(notes_, IsEmpty());
  expect_all_stopped(ranks);
  for (int rank = 1; rank < GetParam(); ++rank) EXPECT_LT(ranks.max_silence_s(rank), 1.2) << "rank " << rank;
}

INSTANTIATE_TEST_SUITE_P(Counts, DispatchOnRanks, testing::Values(1, 2, 3, 5, 7, 64, 301));

TEST_F(Dispatch, HandsOutNothingThatAnEarlierRunHasBaked) {
  ScriptedRanks ranks(3, seed);
  const DispatchResult result = run(ranks, {0, 7, 199});
  expect_each_once(result, 3);
  EXPECT_EQ(ranks.orders(), cells - 3);
  EXPECT_EQ(result.counts, (JobCounts{0, 0, cells, 0, 0}));
}

TEST_F(Dispatch, BakesEveryCellOnceHoweverManyProcessesDie) {
  for (const int count : {1, 2, 5}) {
    ScriptedRanks ranks(count, seed + std::uint64_t(count));
    std::mt19937_64 random(seed);
    int deaths = 0;
    ranks.at = [&](double) {
      if (deaths < 60 && random() % 8 == 0) ranks.kill_process(int(random() % std::uint64_t(count))), ++deaths;
    };
    options_.strikes = 1000;  // no cell is quarantined
    const DispatchResult result = run(ranks);
    expect_each_once(result);
    EXPECT_EQ(result.counts, (JobCounts{0, 0, cells, 0, 0})) << count << " ranks";
    EXPECT_GT(deaths, 20);
    EXPECT_GT(ranks.orders(), cells);
    EXPECT_THAT(notes_, testing::Contains(HasSubstr("is started again: killed by signal 9")));
    expect_all_stopped(ranks);
  }
}

TEST_F(Dispatch, SetsACellAsideThatKillsEveryProcessAndOnlyThatOne) {
  for (const int count : {1, 4}) {
    ScriptedRanks ranks(count, seed);
    ranks.fate = [](int, std::uint32_t job) { return job == 77 ? Fate::kills_the_process : Fate::baked; };
    const DispatchResult result = run(ranks);
    expect_each_once(result);
    EXPECT_EQ(result.counts, (JobCounts{0, 0, cells - 1, 1, 0})) << count << " ranks";
    const auto failed = std::ranges::find(result.reports, 77u, &CellReport::id);
    ASSERT_NE(failed, result.reports.end());
    EXPECT_THAT(failed->error, HasSubstr("killed by signal 9"));
  }
}

TEST_F(Dispatch, TriesAFailedCellElsewhereAndOneThatIsRefusedNoMore) {
  ScriptedRanks ranks(3, seed);
  int refused = 0;
  ranks.fate = [&](int rank, std::uint32_t job) {
    if (job == 5) ++refused;
    return job == 5 ? Fate::refused : rank == 2 ? Fate::failed : Fate::baked;
  };
  const DispatchResult result = run(ranks);
  expect_each_once(result);
  EXPECT_EQ(result.counts, (JobCounts{0, 0, cells - 1, 1, 0}));
  EXPECT_EQ(refused, 1);
}

TEST_F(Dispatch, StopsAtTheFirstCellThatIsSetAsideWhereItIsNotToGoOn) {
  ScriptedRanks ranks(2, seed);
  ranks.fate = [](int, std::uint32_t job) { return job == 100 ? Fate::refused : Fate::baked; };
  options_.keep_going = false;
  const DispatchResult result = run(ranks);
  EXPECT_EQ(result.counts.failed, 1u);
  EXPECT_GT(result.counts.abandoned, 0u);
  EXPECT_FALSE(result.is_drained);
  expect_all_stopped(ranks);
}

/// Ranks report their devices during the dispatch, because no rank waits for the driver of another.
TEST_F(Dispatch, CountsDevicesAndNamesTheRanksThatHaveNone) {
  ScriptedRanks ranks(4, seed);
  int turn = 0;
  const DeviceAnswer gpu{{0, "", 1, 0}, ""}, none{{std::nullopt, "no driver", 1, 0}, ""};
  ranks.at = [&](double) {
    ++turn;
    if (turn == 2) ranks.report_device(3, none);
    if (turn == 5) ranks.report_device(1, gpu), ranks.report_device(0, none);
    if (turn == 7) ranks.report_device(2, gpu);
  };
  const DispatchResult result = run(ranks);
  expect_each_once(result);
  EXPECT_EQ(result.ranks_with_device, 2);
  EXPECT_EQ(result.no_device, "no driver");
  EXPECT_THAT(notes_, testing::UnorderedElementsAre(HasSubstr("rank 3 on "), HasSubstr("rank 0 on ")));
  for (const std::string& note : notes_) EXPECT_THAT(note, HasSubstr(" uses the CPU: no driver"));
}

TEST_F(Dispatch, IsSilentAboutDevicesIfNoRankHasOne) {
  ScriptedRanks ranks(2, seed);
  bool told = false;
  ranks.at = [&](double) {
    if (std::exchange(told, true)) return;
    for (const int rank : {0, 1}) ranks.report_device(rank, {{std::nullopt, "no driver", 1, 0}, ""});
  };
  const DispatchResult result = run(ranks);
  EXPECT_EQ(result.ranks_with_device, 0);
  EXPECT_THAT(notes_, IsEmpty());
}

TEST_F(Dispatch, EndsIfARankCannotGetTheDeviceThatWasRequested) {
  ScriptedRanks ranks(3, seed);
  ranks.at = [&](double now_s) {
    if (now_s > 1) ranks.report_device(2, {{}, "`backend` cuda: out of order"});
  };
  try {
    run(ranks);
    FAIL() << "no error";
  } catch (const std::runtime_error& e) {
    EXPECT_STREQ(e.what(), "`backend` cuda: out of order");
  }
  expect_all_stopped(ranks);
}

TEST_F(Dispatch, GivesTheCellsOfASilentRankToOthers) {
  ScriptedRanks ranks(3, seed);
  ranks.at = [&](double now_s) {
    if (now_s > 1) ranks.stall(2);
  };
  const DispatchResult result = run(ranks);
  expect_each_once(result);
  EXPECT_EQ(result.counts, (JobCounts{0, 0, cells, 0, 0}));
  EXPECT_THAT(result.lost_ranks, ElementsAre(2));
  EXPECT_THAT(notes_, ElementsAre("no message from rank 2; other ranks bake its cells"));
  EXPECT_GT(ranks.in_flight(2), 0u);
  expect_all_stopped(ranks);  // the stalled rank may wake up later
}

TEST_F(Dispatch, WelcomesARankThatWasSilentAndCountsNoneOfItsCellsTwice) {
  for (std::uint64_t round = 0; round < 20; ++round) {
    ScriptedRanks ranks(3, seed + round);
    std::mt19937_64 random(seed + round);
    const double stalls_s = std::uniform_real_distribution(0.2, 5.0)(random);
    ranks.at = [&](double now_s) {
      if (now_s > stalls_s && now_s < stalls_s + 12) ranks.stall(1);
      if (now_s >= stalls_s + 12) ranks.wake(1);
    };
    const DispatchResult result = run(ranks);
    expect_each_once(result);
    EXPECT_THAT(result.lost_ranks, IsEmpty()) << "round " << round << ", seed " << seed;
    EXPECT_EQ(notes_.size(), 1u) << "round " << round << ", seed " << seed;
  }
}

TEST_F(Dispatch, GoesOnAloneWhereEveryOtherRankIsSilent) {
  ScriptedRanks ranks(4, seed);
  for (const int rank : {1, 2, 3}) ranks.stall(rank);
  const DispatchResult result = run(ranks);
  expect_each_once(result);
  EXPECT_EQ(result.counts, (JobCounts{0, 0, cells, 0, 0}));
  EXPECT_THAT(result.lost_ranks, ElementsAre(1, 2, 3));
}

TEST_F(Dispatch, CountsAReportThatComesTwiceOnce) {
  ScriptedRanks ranks(3, seed);
  ranks.fate = [](int, std::uint32_t job) { return job % 50 == 0 ? Fate::failed : Fate::baked; };
  ranks.delivery = [](int, std::uint32_t) { return Delivery::twice; };
  const DispatchResult result = run(ranks);
  expect_each_once(result);
  EXPECT_EQ(result.counts, (JobCounts{0, 0, cells - 4, 4, 0}));
  EXPECT_EQ(ranks.orders(), cells + 4 * 2);  // three attempts each
}

TEST_F(Dispatch, EndsWithALineWhereAReportIsMalformedAndTellsEveryRankToStop) {
  for (std::uint64_t round = 0; round < 20; ++round) {
    ScriptedRanks ranks(3, seed + round);
    ranks.delivery = [](int, std::uint32_t job) { return job == 30 ? Delivery::malformed : Delivery::once; };
    EXPECT_THROW(run(ranks), InputError) << "round " << round << ", seed " << seed;
    expect_all_stopped(ranks);
  }
}

TEST_F(Dispatch, FinishesWhatIsOutWhenItIsAskedToDrain) {
  for (const int count : {1, 3}) {
    ScriptedRanks ranks(count, seed);
    std::size_t orders = 0;
    ranks.at = [&](double now_s) {
      if (now_s < 2 || ranks.is_drain_requested()) return;
      ranks.ask_to_drain();
      orders = ranks.orders();
    };
    const DispatchResult result = run(ranks);
    EXPECT_TRUE(result.is_drained);
    EXPECT_EQ(ranks.orders(), result.counts.done) << "nothing that was begun is left, seed " << seed;
    EXPECT_LE(ranks.orders(), orders + std::size_t(options_.slots * count));  // the cells that were in flight
    EXPECT_EQ(result.counts.abandoned, cells - result.counts.done);
    expect_each_once(result);
    EXPECT_EQ(notes_.size(), 1u);
    EXPECT_EQ(feed_->record().state(), BakeState::draining);
    expect_all_stopped(ranks);
  }
}

/// Combines failures, dead processes, repeated answers and stalled ranks at random.
TEST_F(Dispatch, BakesEveryCellOnceWhateverHappensInWhicheverOrder) {
  for (std::uint64_t round = 0; round < 40; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    std::mt19937_64 random(seed + round);
    const int count = 1 + int(random() % 9);
    ScriptedRanks ranks(count, seed + round);
    ranks.fate = [&](int, std::uint32_t) {
      const std::uint64_t draw = random() % 100;
      return draw == 0 ? Fate::kills_the_process : draw < 4 ? Fate::failed : Fate::baked;
    };
    ranks.delivery = [&](int, std::uint32_t) { return random() % 4 == 0 ? Delivery::twice : Delivery::once; };
    ranks.at = [&](double) {
      for (int rank = 1; rank < count; ++rank) {
        if (random() % 400 == 0) ranks.stall(rank);
        if (random() % 200 == 0) ranks.wake(rank);
      }
    };
    const DispatchResult result = run(ranks);
    expect_each_once(result);
    EXPECT_EQ(result.counts.done + result.counts.failed, cells) << "seed " << seed;
    expect_all_stopped(ranks);
  }
}

}  // namespace
}  // namespace gigabake
