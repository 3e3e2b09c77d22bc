#include "scheduler/queue/work_order.h"

#include <gtest/gtest.h>
#include <numeric>
#include <set>

#include "scheduler/plan/estimate.h"
#include "scheduler/queue/index_set.h"
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

TEST(WorkOrder, NeverLeavesACellThatCostsHalfAsMuchAgainForLater) {
  std::mt19937 random(order_seed);
  const std::vector<CellJob> jobs = made_jobs(900, random);
  WorkOrder order(jobs);
  std::multiset<std::uint64_t> waiting;
  for (const CellJob& job : jobs) waiting.insert(cell_cost(job));
  std::optional<std::uint32_t> last;
  while (const auto job = order.choose(last)) {
    const std::uint64_t cost = cell_cost(jobs[*job]);
    ASSERT_LE(2 * *waiting.rbegin(), 3 * cost + 1) << "order_seed " << order_seed;
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
    const auto job = order.choose(mine);
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
    const std::uint32_t job = *order.choose({});
    tiles.insert(jobs[job].tiles[0]);
    order.take(job);
  }
  EXPECT_EQ(tiles.size(), 16u);
}

}  // namespace
}  // namespace gigabake
