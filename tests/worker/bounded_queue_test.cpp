#include "worker/pipeline/bounded_queue.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <gtest/gtest.h>
#include <thread>
#include <vector>

namespace gigabake {
namespace {

TEST(BoundedQueue, PassesEveryValueOnInOrder) {
  BoundedQueue<int> first, second;
  std::thread giver([&] {
    for (int i = 0; i < 5000; ++i) first.push(i);
    first.close();
  });
  std::thread between([&] {
    while (const auto value = first.take()) second.push(*value);
    second.close();
  });
  int expected = 0;
  while (const auto value = second.take()) EXPECT_EQ(*value, expected++);
  EXPECT_EQ(expected, 5000);
  giver.join();
  between.join();
}

/// Several producers pass values to several consumers, like threads that read back cells and writers.
TEST(BoundedQueue, TakesEveryValueOfSeveralGiversAtOnce) {
  constexpr int givers = 3, takers = 4, values = 3000;
  BoundedQueue<int> handoff;
  std::atomic<int> done{0};
  std::vector<std::atomic<int>> taken(givers * values);
  std::vector<std::thread> threads;
  for (int g = 0; g < givers; ++g)
    threads.emplace_back([&, g] {
      for (int i = 0; i < values; ++i) handoff.push(g * values + i);
      if (++done == givers) handoff.close();
    });
  for (int t = 0; t < takers; ++t)
    threads.emplace_back([&] {
      while (const auto value = handoff.take()) ++taken[std::size_t(*value)];
    });
  for (std::thread& thread : threads) thread.join();
  for (const std::atomic<int>& times : taken) ASSERT_EQ(times, 1);
}

/// A producer is ahead of the consumer by at most the queue's capacity, and the order is preserved.
TEST(BoundedQueue, LetsAGiverGoAheadByItsRoom) {
  constexpr int capacity = 3, values = 40;
  BoundedQueue<int> handoff(capacity);
  std::atomic<int> given{0};
  std::thread giver([&] {
    for (int i = 0; i < values; ++i) {
      handoff.push(i);
      given = i + 1;
    }
    handoff.close();
  });
  for (int taken = 0; taken < values; ++taken) {
    while (given < std::min(taken + capacity, values)) std::this_thread::yield();
    ASSERT_LE(given, taken + capacity);
    ASSERT_EQ(handoff.take(), taken);
  }
  EXPECT_FALSE(handoff.take());
  giver.join();
}

/// push() returns only after its own value is taken, not after another producer's value is taken.
TEST(BoundedQueue, HoldsEachOfSeveralGivers) {
  BoundedQueue<int> handoff;
  std::atomic<int> given{0};
  std::vector<std::thread> givers;
  for (int g = 0; g < 3; ++g)
    givers.emplace_back([&] {
      handoff.push(1);
      ++given;
    });
  for (int taken = 1; taken <= 3; ++taken) {
    EXPECT_EQ(handoff.take(), 1);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_EQ(given, taken);
  }
  for (std::thread& giver : givers) giver.join();
}

TEST(BoundedQueue, HoldsTheGiverUntilTheValueIsTaken) {
  BoundedQueue<int> handoff;
  std::atomic<bool> given{false};
  std::thread giver([&] {
    handoff.push(7);
    given = true;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  EXPECT_FALSE(given);
  EXPECT_EQ(handoff.take(), 7);
  giver.join();
  EXPECT_TRUE(given);
}

TEST(BoundedQueue, YieldsNothingOnceClosed) {
  BoundedQueue<int> handoff;
  handoff.close();
  EXPECT_EQ(handoff.take(), std::nullopt);
  EXPECT_EQ(handoff.take(), std::nullopt);
}

}  // namespace
}  // namespace gigabake
