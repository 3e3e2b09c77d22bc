/// Who writes: as many as the worker's threads allow, however few those are.
#include "worker/write_crew.h"

#include <gtest/gtest.h>

namespace gigabake {
namespace {

WorkerOptions beside_device(int threads) {
  WorkerOptions options;
  options.threads = threads;
  options.cuda_device = 0;
  return options;
}

TEST(WriteCrew, LeavesThreadsToTheOtherStagesWhereThereAreEnough) {
  for (int threads = 1; threads <= 256; ++threads) {
    const WriteCrew crew = write_crew_for(beside_device(threads));
    ASSERT_GE(crew.writers, 2) << threads;
    ASSERT_LE(crew.writers, 4) << threads;
    ASSERT_GE(crew.threads, 1) << threads;
    if (threads < 8) continue;
    ASSERT_LE(crew.writers + crew.threads - 1, threads - 4) << threads;
  }
}

TEST(WriteCrew, WritesFewCellsAtATimeWhereMemoryIsShort) {
  WorkerOptions options = beside_device(32);
  options.memory_bytes = std::uint64_t(1) << 30;
  EXPECT_EQ(write_crew_for(options).writers, 2);
  EXPECT_EQ(write_crew_for(options).threads, 27);
  options.memory_bytes = std::uint64_t(2) << 30;
  EXPECT_EQ(write_crew_for(options).writers, 4);
  options.memory_bytes = std::uint64_t(1) << 62;
  EXPECT_EQ(write_crew_for(options).writers, 4);
}

TEST(WriteCrew, IsOneWriterWithAllThreadsWithoutADevice) {
  WorkerOptions options;
  options.threads = 12;
  EXPECT_EQ(write_crew_for(options).writers, 1);
  EXPECT_EQ(write_crew_for(options).threads, 12);
}

}  // namespace
}  // namespace gigabake
