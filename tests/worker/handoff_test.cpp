#include "worker/handoff.h"

#include <atomic>
#include <chrono>
#include <gtest/gtest.h>
#include <thread>
#include <vector>

namespace gigabake {
namespace {

TEST(Handoff, PassesEveryValueOnInOrder) {
  Handoff<int> first, second;
  std::thread giver([&] {
    for (int i = 0; i < 5000; ++i) first.give(i);
    first.close();
  });
  std::thread between([&] {
    while (const auto value = first.take()) second.give(*value);
    second.close();
  });
  int expected = 0;
  while (const auto value = second.take()) EXPECT_EQ(*value, expected++);
  EXPECT_EQ(expected, 5000);
  giver.join();
  between.join();
}

TEST(Handoff, HoldsTheGiverUntilTheValueIsTaken) {
  Handoff<int> handoff;
  std::atomic<bool> given{false};
  std::thread giver([&] {
    handoff.give(7);
    given = true;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  EXPECT_FALSE(given);
  EXPECT_EQ(handoff.take(), 7);
  giver.join();
  EXPECT_TRUE(given);
}

TEST(Handoff, YieldsNothingOnceClosed) {
  Handoff<int> handoff;
  handoff.close();
  EXPECT_EQ(handoff.take(), std::nullopt);
  EXPECT_EQ(handoff.take(), std::nullopt);
}

}  // namespace
}  // namespace gigabake
