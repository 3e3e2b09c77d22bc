#include "format/system/loading_cache.h"

#include <atomic>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace gigabake {
namespace {

struct Blob {
  int id;
  std::uint64_t size;
  std::uint64_t bytes() const { return size; }
};

class LoadingCacheTest : public testing::Test {
 protected:
  std::shared_ptr<const Blob> get(int id, std::uint64_t size = 10) {
    return cache.get(id, [&] {
      loads.push_back(id);
      return std::make_shared<const Blob>(Blob{id, size});
    });
  }
  LoadingCache<int, Blob> cache{30};
  std::vector<int> loads;
};

TEST_F(LoadingCacheTest, LoadsOnceWhatFits) {
  for (int round = 0; round < 3; ++round)
    for (int id : {1, 2, 3}) EXPECT_EQ(get(id)->id, id);
  EXPECT_EQ(loads, (std::vector{1, 2, 3}));
  EXPECT_EQ(cache.cost(), 30u);
}

TEST_F(LoadingCacheTest, EvictsTheLeastRecentlyUsed) {
  for (int id : {1, 2, 3, 1, 4, 1, 3, 2}) get(id);  // 4 evicts 2, and 2 evicts 4
  EXPECT_EQ(loads, (std::vector{1, 2, 3, 4, 2}));
}

TEST_F(LoadingCacheTest, HandsOnButDoesNotKeepWhatExceedsTheBudget) {
  EXPECT_EQ(get(1, 31)->size, 31u);
  EXPECT_EQ(cache.cost(), 0u);
  get(1, 31);
  EXPECT_EQ(loads, (std::vector{1, 1}));
}

TEST_F(LoadingCacheTest, LoadsAgainWhatWasDropped) {
  const auto held = get(1);
  get(2);
  cache.drop(1);
  cache.drop(7);
  EXPECT_EQ(held->id, 1);
  EXPECT_EQ(cache.cost(), 10u);
  get(2), get(1);
  EXPECT_EQ(loads, (std::vector{1, 2, 1}));
}

// A value larger than the budget is not kept. Such a value once emptied the cache.
TEST_F(LoadingCacheTest, KeepsOtherValuesWhenOneExceedsTheBudget) {
  get(1), get(2);
  get(3, 31);
  get(1), get(2);
  EXPECT_EQ(loads, (std::vector{1, 2, 3}));
}

TEST(LoadingCache, CountsEntriesIfTheirCostIsOne) {
  LoadingCache<int, int, std::hash<int>, CostOfEntry> cache(2);
  int loads = 0;
  for (const int id : {1, 2, 1, 3, 1, 2})  // 3 evicts 2, and 2 evicts 3
    EXPECT_EQ(*cache.get(id, [&] { return ++loads, std::make_shared<const int>(id); }), id);
  EXPECT_EQ(loads, 4);
  EXPECT_EQ(cache.cost(), 2u);
}

TEST_F(LoadingCacheTest, LeavesAnEvictedValueToWhoHoldsIt) {
  const auto held = get(1, 30);
  get(2, 30);
  EXPECT_EQ(held->id, 1);
  EXPECT_EQ(cache.cost(), 30u);
}

TEST_F(LoadingCacheTest, LoadsAgainAfterALoadThatThrew) {
  const auto failing = [&] {
    return cache.get(1, []() -> std::shared_ptr<const Blob> { throw std::runtime_error("disk"); });
  };
  EXPECT_THROW(failing(), std::runtime_error);
  EXPECT_THROW(failing(), std::runtime_error);
  EXPECT_EQ(get(1)->id, 1);
}

TEST_F(LoadingCacheTest, ReturnsAValueThatWasLoadedAhead) {
  const auto load_ahead = [&](int id) {
    cache.load_ahead(id, [&] {
      loads.push_back(id);
      return std::make_shared<const Blob>(Blob{id, 10});
    });
  };
  load_ahead(1), load_ahead(1);
  EXPECT_EQ(get(1)->id, 1);
  load_ahead(1);
  EXPECT_EQ(loads, std::vector{1});
}

TEST_F(LoadingCacheTest, LoadsAgainAfterALoadAheadThatThrew) {
  cache.load_ahead(1, []() -> std::shared_ptr<const Blob> { throw std::runtime_error("disk"); });
  EXPECT_EQ(cache.cost(), 0u);
  EXPECT_EQ(get(1)->id, 1);
  EXPECT_EQ(loads, std::vector{1});
}

TEST_F(LoadingCacheTest, DoesNotLoadAheadWhatIsBeingLoaded) {
  const auto value = cache.get(1, [&] {
    std::thread([&] {
      cache.load_ahead(1, []() -> std::shared_ptr<const Blob> { throw std::logic_error("two loads"); });
    }).join();  // returns, although the value is not loaded yet
    return std::make_shared<const Blob>(Blob{1, 10});
  });
  EXPECT_EQ(value->id, 1);
}

TEST(LoadingCache, LoadsOnceForManyThreads) {
  LoadingCache<std::string, Blob> cache(1000);
  std::atomic<int> loads{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&] {
      const auto value = cache.get("tile", [&] {
        ++loads;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        return std::make_shared<const Blob>(Blob{7, 1});
      });
      EXPECT_EQ(value->id, 7);
    });
  for (auto& t : threads) t.join();
  EXPECT_EQ(loads, 1);
}

TEST(LoadingCache, StaysWithinItsBudgetUnderManyThreads) {
  LoadingCache<int, Blob> cache(50);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < 2000; ++i) {
        const int id = (i * (t + 1)) % 17;
        const auto value = cache.get(id, [&] { return std::make_shared<const Blob>(Blob{id, std::uint64_t(id)}); });
        EXPECT_EQ(value->id, id);
        EXPECT_LE(cache.cost(), 50u);
      }
    });
  for (auto& t : threads) t.join();
}

}  // namespace
}  // namespace gigabake
