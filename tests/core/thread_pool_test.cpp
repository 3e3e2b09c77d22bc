#include "core/base/thread_pool.h"

#include <array>
#include <atomic>
#include <chrono>
#include <gtest/gtest.h>
#include <stdexcept>
#include <thread>
#include <vector>

namespace gigabake::kernels {
namespace {

class ThreadPoolTest : public testing::TestWithParam<int> {};

TEST_P(ThreadPoolTest, RunsEveryIndexExactlyOnceInRangesOfAtMostTheGrain) {
  const ThreadPool pool(GetParam());
  for (const std::size_t count : {0u, 1u, 7u, 64u, 1000u})
    for (const std::size_t grain : {0u, 1u, 3u, 64u, 5000u}) {
      std::vector<std::atomic<int>> visits(count);
      std::atomic<bool> ranges_fit{true}, threads_fit{true};
      pool.parallel_for(count, grain, [&](std::size_t begin, std::size_t end, int thread) {
        if (begin >= end || end - begin > std::max<std::size_t>(grain, 1)) ranges_fit = false;
        if (thread < 0 || thread >= pool.threads()) threads_fit = false;
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      EXPECT_TRUE(ranges_fit && threads_fit) << "count " << count << ", grain " << grain;
      for (const auto& v : visits) ASSERT_EQ(v, 1) << "count " << count << ", grain " << grain;
    }
}

TEST_P(ThreadPoolTest, RethrowsABodysExceptionAndStaysUsable) {
  const ThreadPool pool(GetParam());
  for (int round = 0; round < 50; ++round) {
    EXPECT_THROW(pool.parallel_for(100, 1,
                                   [](std::size_t begin, std::size_t, int) {
                                     if (begin % 10 == 3) throw std::runtime_error("range");
                                   }),
                 std::runtime_error);
    std::atomic<int> ran{0};
    pool.parallel_for(100, 1, [&](std::size_t, std::size_t, int) { ++ran; });
    EXPECT_EQ(ran, 100);
  }
}

TEST_P(ThreadPoolTest, NeverRunsTwoRangesOfOneThreadIndexAtOnce) {
  const ThreadPool pool(GetParam());
  std::vector<std::atomic<int>> busy(std::size_t(pool.threads()));
  std::atomic<bool> clashed{false};
  for (int loop = 0; loop < 2000; ++loop)
    pool.parallel_for(8, 1, [&](std::size_t, std::size_t, int thread) {
      if (busy[std::size_t(thread)]++ != 0) clashed = true;
      --busy[std::size_t(thread)];
    });
  EXPECT_FALSE(clashed);
}

TEST_P(ThreadPoolTest, RunsEveryIndexOfSeveralCallersLoops) {
  const ThreadPool pool(GetParam());
  std::atomic<std::uint64_t> sum{0};
  std::vector<std::thread> callers;
  for (int c = 0; c < 3; ++c)
    callers.emplace_back([&] {
      for (int loop = 0; loop < 200; ++loop)
        pool.parallel_for(50, 4, [&](std::size_t begin, std::size_t end, int) { sum += end - begin; });
    });
  for (auto& caller : callers) caller.join();
  EXPECT_EQ(sum, 3u * 200u * 50u);
}

TEST_P(ThreadPoolTest, RunsAStartedLoopWhileTheCallerRunsOthers) {
  const ThreadPool pool(GetParam());
  for (const std::size_t count : {0u, 1u, 7u, 1000u}) {
    std::vector<std::atomic<int>> visits(count);
    std::atomic<std::size_t> others{0};
    ThreadPool::Running running = pool.start(count, 3, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    for (int loop = 0; loop < 20; ++loop)
      pool.parallel_for(50, 4, [&](std::size_t begin, std::size_t end, int) { others += end - begin; });
    running.finish();
    EXPECT_EQ(others, 20u * 50u);
    for (const auto& v : visits) ASSERT_EQ(v, 1) << "count " << count;
  }
}

/// The threads do not use the data of a dropped loop afterwards. The sanitizers check this.
TEST_P(ThreadPoolTest, EndsTheBodiesOfALoopThatIsDropped) {
  const ThreadPool pool(GetParam());
  for (int round = 0; round < 200; ++round) {
    std::vector<int> visits(100);
    {
      const ThreadPool::Running running =
          pool.start(visits.size(), 1, [&](std::size_t begin, std::size_t, int) { ++visits[begin]; });
    }
    for (const int v : visits) ASSERT_LE(v, 1);
  }
}

TEST_P(ThreadPoolTest, RethrowsTheExceptionOfAStartedLoopWhenItIsFinished) {
  const ThreadPool pool(GetParam());
  ThreadPool::Running running = pool.start(100, 1, [](std::size_t begin, std::size_t, int) {
    if (begin == 50) throw std::runtime_error("range");
  });
  EXPECT_THROW(running.finish(), std::runtime_error);
  std::atomic<int> ran{0};
  pool.parallel_for(100, 1, [&](std::size_t, std::size_t, int) { ++ran; });
  EXPECT_EQ(ran, 100);
}

/// Each body waits for a body of the other loop. If the two loops ran one after the other, neither would end.
TEST(ThreadPool, RunsTheLoopsOfTwoCallersAtOnce) {
  const ThreadPool pool(2);
  std::array<std::atomic<bool>, 2> began{};
  std::array<std::atomic<int>, 2> met{};
  const auto call = [&](std::size_t own) {
    pool.parallel_for(8, 1, [&](std::size_t, std::size_t, int) {
      began[own] = true;
      const auto late = std::chrono::steady_clock::now() + std::chrono::seconds(20);
      while (!began[1 - own] && std::chrono::steady_clock::now() < late) std::this_thread::yield();
      if (began[1 - own]) ++met[own];
    });
  };
  std::thread other([&] { call(1); });
  call(0);
  other.join();
  EXPECT_EQ(met[0], 8);
  EXPECT_EQ(met[1], 8);
}

INSTANTIATE_TEST_SUITE_P(Threads, ThreadPoolTest, testing::Values(1, 2, 3, 8));

TEST(ThreadPool, RunsInTheCallersThreadWhenItHasOneThread) {
  const ThreadPool pool(1);
  const auto caller = std::this_thread::get_id();
  pool.parallel_for(10, 1, [&](std::size_t, std::size_t, int thread) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    EXPECT_EQ(thread, 0);
  });
}

TEST(ThreadPool, WorksOnAfterBeingMoved) {
  ThreadPool first(3);
  const ThreadPool second(std::move(first));
  std::atomic<int> ran{0};
  second.parallel_for(100, 1, [&](std::size_t, std::size_t, int) { ++ran; });
  EXPECT_EQ(ran, 100);
  EXPECT_EQ(second.threads(), 3);
}

TEST(ThreadPool, TakesFewerThanOneThreadAsOne) { EXPECT_EQ(ThreadPool(0).threads(), 1); }

}  // namespace
}  // namespace gigabake::kernels
