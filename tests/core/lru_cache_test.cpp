#include "core/base/lru_cache.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <list>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace gigabake {
namespace {

using Strings = std::vector<std::string>;

TEST(LruCache, EvictsTheLeastRecentlyUsedValues) {
  LruCache<int, std::string> cache(30);
  EXPECT_EQ(cache.insert(1, "a", 10), Strings{});
  EXPECT_EQ(cache.insert(2, "b", 10), Strings{});
  EXPECT_EQ(cache.insert(3, "c", 10), Strings{});
  EXPECT_EQ(*cache.find(1), "a");
  EXPECT_EQ(cache.insert(4, "d", 20), (Strings{"b", "c"}));
  EXPECT_EQ(cache.find(2), nullptr);
  EXPECT_EQ(*cache.find(1), "a");
  EXPECT_EQ(cache.cost(), 30u);
}

TEST(LruCache, ReplacesTheValueOfAKey) {
  LruCache<int, std::string> cache(30);
  EXPECT_EQ(cache.insert(1, "a", 30), Strings{});
  EXPECT_EQ(cache.insert(1, "b", 5), Strings{"a"});
  EXPECT_EQ(*cache.find(1), "b");
  EXPECT_EQ(cache.cost(), 5u);
}

TEST(LruCache, ReturnsAValueAboveTheCapacityAndEvictsNoOther) {
  LruCache<int, std::string> cache(30);
  EXPECT_EQ(cache.insert(1, "a", 30), Strings{});
  EXPECT_EQ(cache.insert(2, "b", 31), Strings{"b"});
  EXPECT_NE(cache.find(1), nullptr);
  EXPECT_EQ(cache.insert(1, "c", 31), (Strings{"a", "c"})) << "the earlier value of the key is outdated";
  EXPECT_EQ(cache.cost(), 0u);
}

TEST(LruCache, KeepsTheMinNumberOfEntriesAboveTheCapacity) {
  LruCache<int, std::string> cache(30, 1);
  EXPECT_EQ(cache.insert(1, "a", 31), Strings{});
  EXPECT_EQ(*cache.find(1), "a");
  EXPECT_EQ(cache.insert(2, "b", 40), Strings{"a"});
  EXPECT_EQ(cache.cost(), 40u);
}

TEST(LruCache, EvictsAValueFirstAfterItsLastUse) {
  LruCache<int, std::string> cache(30);
  for (const int key : {1, 2, 3}) EXPECT_EQ(cache.insert(key, std::to_string(key), 10), Strings{});
  EXPECT_EQ(*cache.find_for_last_use(3), "3");
  EXPECT_EQ(cache.insert(4, "4", 10), Strings{"3"});
}

TEST(LruCache, ErasesValuesAndHoldsMoveOnlyValues) {
  LruCache<std::string, std::unique_ptr<int>> cache(2);
  EXPECT_TRUE(cache.insert("a", std::make_unique<int>(1), 1).empty());
  const auto erased = cache.erase("a");
  ASSERT_TRUE(erased.has_value());
  EXPECT_EQ(**erased, 1);
  EXPECT_FALSE(cache.erase("a").has_value());
  EXPECT_EQ(cache.cost(), 0u);
}

TEST(LruCache, AgreesWithASearchedListForRandomUses) {
  struct Entry {
    int key;
    std::uint64_t cost;
  };
  std::mt19937 rng(7);
  LruCache<int, int> cache(100);
  std::list<Entry> expected;  // most recently used first
  for (int i = 0; i < 20000; ++i) {
    const int key = int(rng() % 30);
    const auto same = [&](const Entry& e) { return e.key == key; };
    const auto at = std::find_if(expected.begin(), expected.end(), same);
    ASSERT_EQ(cache.find(key) != nullptr, at != expected.end()) << "step " << i;
    if (at != expected.end()) {
      expected.splice(expected.begin(), expected, at);
      continue;
    }
    const std::uint64_t cost = rng() % 40;
    expected.push_front({key, cost});
    std::uint64_t sum = 0;
    for (const Entry& e : expected) sum += e.cost;
    std::size_t evicted = 0;
    for (; sum > 100; ++evicted) sum -= expected.back().cost, expected.pop_back();
    ASSERT_EQ(cache.insert(key, key, cost).size(), evicted) << "step " << i;
    ASSERT_EQ(cache.cost(), sum) << "step " << i;
  }
}

}  // namespace
}  // namespace gigabake
