#include "worker/pipeline/live_count.h"

#include <atomic>
#include <gtest/gtest.h>
#include <thread>

namespace gigabake {
namespace {

TEST(LiveCount, WaitsUntilItIsEnoughOrNothingIsCounted) {
  LiveCount count;
  count.wait_until([] { return false; });
  std::atomic<int> used = 2;
  std::atomic<bool> is_over = false;
  auto first = count.add(), second = count.add();
  std::thread waiting([&] {
    count.wait_until([&] { return used <= 1; });
    is_over = true;
  });
  EXPECT_FALSE(count.is_zero());
  EXPECT_FALSE(is_over);
  used = 1;
  first.reset();
  waiting.join();
  EXPECT_TRUE(is_over);
  std::thread last([&] { count.wait_until([] { return false; }); });
  second.reset();
  last.join();
  EXPECT_TRUE(count.is_zero());
}

}  // namespace
}  // namespace gigabake
