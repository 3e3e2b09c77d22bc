#include "scheduler/queue/work_order.h"

#include <functional>
#include <gtest/gtest.h>
#include <queue>
#include <set>
#include <tuple>

#include "scheduler/plan/estimate.h"
#include "scheduler/plan/overviews.h"
#include "scheduler/queue/index_set.h"
#include "scheduler/queue/schedule.h"
#include "tests/scheduler/made_jobs.h"

namespace gigabake {
namespace {

constexpr unsigned order_seed = 78;

TEST(IndexSet, AgreesWithAnOrderedSetWhateverItsSize) {
  std::mt19937 random(order_seed);
  for (const std::uint32_t size : {0u, 1u, 63u, 64u, 65u, 4096u, 4097u, 300000u}) {
    std::set<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < size; ++i) expected.insert(expected.end(), i);
    IndexSet set(size);
    for (int i = 0; i < 20000; ++i) {
      const auto x = std::uint32_t(random() % (size + 200));
      const auto above = expected.lower_bound(x);
      ASSERT_EQ(set.at_or_after(x), above == expected.end() ? std::nullopt : std::optional(*above))
          << "order_seed " << order_seed << " size " << size << " item " << i;
      ASSERT_EQ(set.before(x), above == expected.begin() ? std::nullopt : std::optional(*std::prev(above)))
          << "order_seed " << order_seed << " size " << size << " item " << i;
      if (above == expected.end()) continue;
      set.erase(*above);
      expected.erase(above);
    }
  }
}

TEST(WorkOrder, LeavesForLaterOnlyCellsOfSimilarCostOrBeforeTheEndUpToTwiceTheMean) {
  std::mt19937 random(order_seed);
  const std::vector<CellJob> jobs = made_jobs(900, random);
  WorkOrder order(jobs);
  std::multiset<std::uint64_t> waiting;
  std::uint64_t sum = 0;
  for (const CellJob& job : jobs) sum += *waiting.insert(cell_cost(job));
  const std::uint64_t twice_the_mean = 2 * sum / jobs.size();
  ASSERT_GT(*waiting.rbegin(), 2 * twice_the_mean) << "the rule for expensive cells is tested, too";
  std::optional<std::uint32_t> last;
  const auto is_ending = [&] { return waiting.size() < 300; };
  while (const auto job = order.choose(0, last, is_ending())) {
    const std::uint64_t cost = cell_cost(jobs[*job]);
    const std::uint64_t similar = 3 * cost + 1;
    ASSERT_LE(2 * *waiting.rbegin(), is_ending() ? similar : std::max(2 * twice_the_mean, similar))
        << "order_seed " << order_seed;
    waiting.erase(waiting.find(cost));
    order.take(*job);
    last = job;
  }
  EXPECT_TRUE(waiting.empty());
}

TEST(WorkOrder, FollowsTheTilesThatAWorkerHasRead) {
  const std::vector<CellJob> jobs = equal_jobs(900);
  WorkOrder order(jobs);
  std::vector<std::optional<std::uint32_t>> last(10);
  int moves = 0;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    auto& mine = last[i % last.size()];
    const auto job = order.choose(int(i % last.size()), mine, false);
    moves += !mine || jobs[*mine].tiles != jobs[*job].tiles ? 1 : 0;
    order.take(*job);
    mine = job;
  }
  EXPECT_LT(moves, 300) << "100 tiles, and 10 workers that sometimes share a tile";
}

TEST(WorkOrder, StartsWorkersFarApart) {
  const std::vector<CellJob> jobs = equal_jobs(900);
  WorkOrder order(jobs);
  std::set<std::uint32_t> tiles;
  for (int worker = 0; worker < 16; ++worker) {
    const std::uint32_t job = *order.choose(worker, {}, false);
    tiles.insert(jobs[job].tiles[0]);
    order.take(job);
  }
  EXPECT_EQ(tiles.size(), 16u);
}

/// Returns cells, at least a thousand of random cost, with their overviews.
std::vector<CellJob> cells_with_overviews(std::mt19937& random) {
  std::vector<CellJob> jobs = made_jobs(1800, random);
  add_overviews(jobs);
  return jobs;
}

/// Runs all jobs with workers of equal speed. Returns the number of overviews' children, and how many of them another
/// worker than the overview's finished.
std::pair<std::size_t, std::size_t> children_from_elsewhere(const std::vector<CellJob>& jobs, int workers) {
  Schedule schedule(jobs, {.slots = device_worker_slots});
  struct Baked {
    double at_s;
    int worker;
    Assignment assignment;
    bool operator>(const Baked& o) const { return std::tie(at_s, worker) > std::tie(o.at_s, o.worker); }
  };
  std::priority_queue<Baked, std::vector<Baked>, std::greater<>> in_flight;
  std::vector<double> free_s(std::size_t(workers), 0);
  std::vector<int> baked_by(jobs.size(), -1);
  double now_s = 0;
  const auto dispatch = [&] {
    for (bool gave = true; gave;) {
      gave = false;
      for (int w = 0; w < workers; ++w)
        if (const auto a = schedule.next(w, now_s)) {
          double& free = free_s[std::size_t(w)];
          free = std::max(free, now_s) + 1e-3 * double(cell_cost(jobs[a->job]));
          in_flight.push({free, w, *a});
          baked_by[a->job] = w;
          gave = true;
        }
    }
  };
  for (int w = 0; w < workers; ++w) schedule.heard_from(w, 0);
  for (dispatch(); !in_flight.empty(); dispatch()) {
    const Baked next = in_flight.top();
    in_flight.pop();
    now_s = next.at_s;
    schedule.finished(next.worker, next.assignment.job, next.assignment.attempt, now_s);
  }
  EXPECT_EQ(schedule.counts().done, jobs.size());
  std::size_t children = 0, elsewhere = 0;
  for (const CellJob& job : jobs)
    for (const std::uint32_t child : job.children)
      if (!is_overview(jobs[child])) ++children, elsewhere += baked_by[child] != baked_by[job.id];
  return {children, elsewhere};
}

TEST(WorkOrder, LeavesTheCellsOfAnOverviewToTheWorkerThatMakesIt) {
  std::mt19937 random(order_seed);
  const std::vector<CellJob> jobs = cells_with_overviews(random);
  for (const auto& [workers, max_fraction] : {std::pair{1, 0.0}, {2, 0.1}, {3, 0.15}, {4, 0.2}, {8, 0.4}}) {
    const auto [children, elsewhere] = children_from_elsewhere(jobs, workers);
    ASSERT_GE(children, 1800u);
    EXPECT_LE(double(elsewhere), max_fraction * double(children)) << workers << " workers, order_seed " << order_seed;
  }
}

}  // namespace
}  // namespace gigabake
