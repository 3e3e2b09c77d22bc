#include "cluster/process/hang_watch.h"

#include <gtest/gtest.h>

namespace gigabake {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Time = HangWatch::Clock::time_point;

const Time begin = Time() + std::chrono::hours(5);

/// Returns a watch that has sampled `activity_at` every half second.
template <class Activity>
HangWatch watched_for(seconds time, const Activity& activity_at) {
  HangWatch watch(seconds(60));
  watch.start(begin);
  for (milliseconds t{0}; t <= time; t += milliseconds(500)) watch.look(begin + t, activity_at(t.count() / 1000), 0);
  return watch;
}

TEST(HangWatch, TakesNoCpuTimeNoDataAndNoMessageForAHang) {
  const auto nothing = [](auto) { return ProcessActivity(); };
  EXPECT_FALSE(watched_for(seconds(59), nothing).is_stalled());
  EXPECT_TRUE(watched_for(seconds(60), nothing).is_stalled());
}

TEST(HangWatch, TakesAnyKindOfProgressForWork) {
  const seconds long_time(1000);
  const auto rarely = [](auto s) { return std::uint64_t(s / 50); };
  EXPECT_FALSE(watched_for(long_time, [&](auto s) { return ProcessActivity{rarely(s), 0, 0}; }).is_stalled());
  EXPECT_FALSE(watched_for(long_time, [&](auto s) { return ProcessActivity{0, rarely(s), 0}; }).is_stalled());
  EXPECT_FALSE(watched_for(long_time, [&](auto s) { return ProcessActivity{0, 0, rarely(s)}; }).is_stalled());
  HangWatch watch(seconds(60));
  watch.start(begin);
  for (int s = 0; s < 1000; ++s) watch.look(begin + seconds(s), ProcessActivity(), std::uint64_t(s / 50));
  EXPECT_FALSE(watch.is_stalled());
}

TEST(HangWatch, JudgesNobodyWhomItCannotSee) {
  EXPECT_FALSE(watched_for(seconds(1000), [](auto) { return std::optional<ProcessActivity>(); }).is_stalled());
}

TEST(HangWatch, DoesNotCountTimeInWhichItsOwnerWasStopped) {
  HangWatch watch(seconds(60));
  watch.start(begin);
  watch.look(begin + seconds(1), ProcessActivity(), 0);
  watch.look(begin + std::chrono::hours(8), ProcessActivity(), 0);
  EXPECT_FALSE(watch.is_stalled());
  EXPECT_LE(watch.watched(), seconds(16));
}

TEST(HangWatch, DoesNotCountTimeWithNothingToDo) {
  HangWatch watch(seconds(60));
  watch.start(begin);
  for (int s = 0; s < 50; ++s) watch.look(begin + seconds(s), ProcessActivity(), 0);
  watch.start(begin + seconds(5000));
  for (int s = 5000; s < 5050; ++s) watch.look(begin + seconds(s), ProcessActivity(), 0);
  EXPECT_FALSE(watch.is_stalled());
}

}  // namespace
}  // namespace gigabake
