#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <sstream>

#include "scheduler/plan/overviews.h"
#include "scheduler/queue/schedule.h"
#include "tests/scheduler/made_jobs.h"

namespace gigabake {
namespace {

constexpr unsigned first_seed = 1000;
constexpr int workers = 6;

/// Simulation of workers that fail at random. It checks the invariants after each event.
class Ordeal {
 public:
  Ordeal(unsigned seed, const std::vector<CellJob>& jobs)
      : random_(seed), jobs_(jobs), schedule_(jobs, {}), times_done_(jobs.size()) {}

  /// Runs the simulation. Returns the log of all answers, which depends only on the seed.
  std::string run() {
    for (int step = 0; step < 200000 && !schedule_.is_over() && !testing::Test::HasFatalFailure(); ++step) {
      now_s_ += 0.1;
      one_event(step > 20000 ? 60 : random_() % 100);  // at the end there are no more failures
      check();
    }
    EXPECT_TRUE(schedule_.is_over());
    check_ends();
    return log_.str();
  }

 private:
  void one_event(std::uint64_t chance) {
    const int worker = int(random_() % workers);
    if (chance < 30) return ask(worker);
    if (chance < 88) return report(chance < 70, random_() % 5 == 0 ? anybodys_old() : current());
    if (chance < 90) return die(worker);
    if (chance == 99 && random_() % 200 == 0) schedule_.stop();
    if (chance < 91) now_s_ += double(random_() % 40);
    if (chance < 95) return schedule_.heard_from(worker, now_s_);
    if (chance < 96) lose_silent();
    for (int w = 0; w < workers; ++w) ask(w);
  }

  void ask(int worker) {
    const auto a = schedule_.next(worker, now_s_);
    if (!a) return;
    log_ << "n" << worker << ' ' << a->job << ' ' << a->attempt << (a->alone ? "!" : "") << '\n';
    ASSERT_LE(++attempts_[a->job], 5u);
    ASSERT_EQ(a->attempt, attempts_[a->job]);
    for (const std::uint32_t child : jobs_[a->job].children) {
      const JobState s = schedule_.state(child);
      ASSERT_TRUE(s == JobState::done || s == JobState::failed) << "overview " << a->job << " before child " << child;
    }
    auto& hand = hands_[worker];
    ASSERT_TRUE(hand.empty() || (!a->alone && !hand.back().alone)) << "another cell during an isolated retry";
    hand.push_back(*a);
    ASSERT_LE(hand.size(), std::size_t(worker_slots));
    given_.push_back({worker, *a});
  }

  std::pair<int, Assignment> anybodys_old() {
    return given_.empty() ? std::pair(0, Assignment{}) : given_[random_() % given_.size()];
  }
  std::pair<int, Assignment> current() {
    const int start = int(random_() % workers);
    for (int i = 0; i < workers; ++i)
      if (const auto& hand = hands_[(start + i) % workers]; !hand.empty()) return {(start + i) % workers, hand[0]};
    for (int w = 0; w < workers; ++w) schedule_.heard_from(w, now_s_), ask(w);
    return anybodys_old();
  }

  void report(bool good, const std::pair<int, Assignment>& of) {
    const auto& [worker, a] = of;
    auto& hand = hands_[worker];
    const auto held = std::find(hand.begin(), hand.end(), a);
    const bool in_hand = held != hand.end();
    const JobCounts before = schedule_.counts();
    const Verdict v = good ? schedule_.finished(worker, a.job, a.attempt, now_s_)
                           : schedule_.failed(worker, a.job, a.attempt, "no", now_s_);
    log_ << (good ? "g" : "b") << worker << ' ' << a.job << ' ' << int(v) << '\n';
    if (in_hand) {
      ASSERT_EQ(v, Verdict::accepted);
      hand.erase(held);
    }
    if (v == Verdict::stale) {
      ASSERT_EQ(schedule_.counts(), before) << "a stale result changed counts";
    } else if (good) {
      ++times_done_[a.job];
      ASSERT_EQ(schedule_.state(a.job), JobState::done);
    }
  }

  void die(int worker) {
    schedule_.process_died(worker, "died", now_s_);
    hands_[worker].clear();
  }

  void lose_silent() {
    for (const int w : schedule_.silent(now_s_)) {
      log_ << "s" << w << '\n';
      hands_[w].clear();
    }
  }

  void check() {
    std::size_t held = 0;
    for (const auto& [worker, hand] : hands_) held += hand.size();
    const JobCounts c = schedule_.counts();
    ASSERT_EQ(c.running, held);
    ASSERT_EQ(c.pending + c.running + c.done + c.failed + c.abandoned, jobs_.size());
  }

  void check_ends() {
    JobCounts c;
    for (std::uint32_t j = 0; j < jobs_.size(); ++j) {
      const JobState s = schedule_.state(j);
      ASSERT_TRUE(s == JobState::done || s == JobState::failed || s == JobState::abandoned);
      ASSERT_EQ(times_done_[j], s == JobState::done ? 1 : 0);
      ASSERT_TRUE(s != JobState::failed || schedule_.error(j).find("(tried 3 times)") != std::string::npos);
      ++(s == JobState::done ? c.done : s == JobState::failed ? c.failed : c.abandoned);
    }
    ASSERT_EQ(c, schedule_.counts());
    ASSERT_EQ(schedule_.take_quarantined().size(), c.failed);
  }

  std::mt19937 random_;
  const std::vector<CellJob>& jobs_;
  Schedule schedule_;
  double now_s_ = 0;
  std::map<int, std::vector<Assignment>> hands_;
  std::vector<std::pair<int, Assignment>> given_;
  std::map<std::uint32_t, std::uint32_t> attempts_;
  std::vector<int> times_done_;
  std::ostringstream log_;
};

TEST(ScheduleAtRandom, LosesNoCellBakesNoneTwiceAndEnds) {
  for (unsigned seed = first_seed; seed < first_seed + 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::vector<CellJob> jobs = made_jobs(1 + random() % 300, random);
    if (seed % 2 == 0) add_overviews(jobs);
    Ordeal(seed, jobs).run();
    if (testing::Test::HasFailure()) return;
  }
}

TEST(ScheduleAtRandom, AnswersTheSameCallsAlike) {
  for (unsigned seed = first_seed; seed < first_seed + 20; ++seed) {
    std::mt19937 random(seed);
    std::vector<CellJob> jobs = made_jobs(200, random);
    add_overviews(jobs);
    const std::string log = Ordeal(seed, jobs).run();
    EXPECT_EQ(Ordeal(seed, jobs).run(), log) << "seed " << seed;
    EXPECT_GT(log.size(), 1000u);
  }
}

}  // namespace
}  // namespace gigabake
