/// The times of stages on a clock that the test advances: each interval counts once.
#include "format/system/meters/stage_clock.h"

#include <gtest/gtest.h>

namespace gigabake {
namespace {

using std::chrono::seconds;

class StageClockTest : public testing::Test {
 protected:
  StageClock::Clock::time_point at(int s) const { return begin_ + seconds(s); }
  StageClock clock_;

 private:
  const StageClock::Clock::time_point begin_ = StageClock::Clock::now();
};

TEST_F(StageClockTest, IsAtZeroBeforeTheFirstStage) {
  const StageTimes times = clock_.times(at(9));
  EXPECT_EQ(times.all_s(), 0);
  EXPECT_EQ(times.bound(), std::nullopt);
}

TEST_F(StageClockTest, PartitionsTheTimeSinceTheFirstStage) {
  clock_.enter(BakeStage::reading, at(1));
  clock_.enter(BakeStage::kernels, at(3));
  clock_.leave(BakeStage::reading, at(4));
  clock_.leave(BakeStage::kernels, at(9));
  clock_.enter(BakeStage::writing, at(12));
  const StageTimes times = clock_.times(at(14));
  EXPECT_EQ(times.exclusive_s, (std::array<double, 4>{2, 5, 0, 2}));
  EXPECT_EQ(times.several_s, 1);
  EXPECT_EQ(times.idle_s, 3);
  EXPECT_EQ(times.all_s(), 13);
  EXPECT_EQ(times.bound(), BakeStage::kernels);
}

TEST_F(StageClockTest, CountsAStageOnceForSeveralThreads) {
  clock_.enter(BakeStage::packing, at(0));
  clock_.enter(BakeStage::packing, at(1));
  clock_.leave(BakeStage::packing, at(2));
  clock_.leave(BakeStage::packing, at(5));
  EXPECT_EQ(clock_.times(at(5)).exclusive_s[std::size_t(BakeStage::packing)], 5);
}

TEST_F(StageClockTest, ReadsTimesWithoutChangingThem) {
  clock_.enter(BakeStage::reading, at(0));
  EXPECT_EQ(clock_.times(at(2)).exclusive_s[0], 2);
  EXPECT_EQ(clock_.times(at(3)).exclusive_s[0], 3);
}

// Threads read the clock before they lock its mutex, so times may arrive out of order.
TEST_F(StageClockTest, CountsNoIntervalTwiceIfTimesAreOutOfOrder) {
  clock_.enter(BakeStage::reading, at(0));
  clock_.enter(BakeStage::kernels, at(5));
  clock_.leave(BakeStage::kernels, at(4));
  clock_.leave(BakeStage::reading, at(6));
  const StageTimes times = clock_.times(at(6));
  EXPECT_EQ(times.all_s(), 6);
  EXPECT_EQ(times.exclusive_s[0], 6);
}

TEST_F(StageClockTest, DifferencesAddUpToTheWhole) {
  clock_.enter(BakeStage::reading, at(0));
  const StageTimes first = clock_.times(at(2));
  clock_.leave(BakeStage::reading, at(3));
  StageTimes sum = first;
  sum += clock_.times(at(7)).since(first);
  EXPECT_EQ(sum.exclusive_s[0], 3);
  EXPECT_EQ(sum.idle_s, 4);
}

}  // namespace
}  // namespace gigabake
