/// The number of writers follows the worker's thread limit, even if that is small.
#include "worker/pipeline/writer_pool_size.h"

#include <gtest/gtest.h>
#include <utility>

namespace gigabake {
namespace {

WorkerOptions beside_device(int threads) {
  WorkerOptions options;
  options.threads = threads;
  options.cuda_device = 0;
  return options;
}

TEST(WriterPoolSize, LeavesThreadsToTheOtherStagesWhereThereAreEnough) {
  for (int threads = 1; threads <= 256; ++threads) {
    const WriterPoolSize crew = writer_pool_size_for(beside_device(threads));
    ASSERT_GE(crew.writers, 2) << threads;
    ASSERT_LE(crew.writers, 4) << threads;
    ASSERT_GE(crew.threads, 1) << threads;
    if (threads < 8) continue;
    ASSERT_LE(crew.writers + crew.threads - 1, threads - 4) << threads;
  }
}

TEST(WriterPoolSize, WritesFewCellsAtATimeWhereMemoryIsShort) {
  WorkerOptions options = beside_device(32);
  options.memory_bytes = std::uint64_t(1) << 30;
  EXPECT_EQ(writer_pool_size_for(options).writers, 2);
  EXPECT_EQ(writer_pool_size_for(options).threads, 27);
  options.memory_bytes = std::uint64_t(2) << 30;
  EXPECT_EQ(writer_pool_size_for(options).writers, 4);
  options.memory_bytes = std::uint64_t(1) << 62;
  EXPECT_EQ(writer_pool_size_for(options).writers, 4);
}

TEST(CellsAhead, AreFewWhereMemoryIsShortAndNoneWithoutADevice) {
  WorkerOptions options = beside_device(16);
  EXPECT_EQ(readahead_cells_for(options), 3u);
  for (const auto& [gibibytes, ahead] : {std::pair(0.5, 0u), {1.5, 1u}, {2.0, 2u}, {3.0, 3u}, {64.0, 3u}}) {
    options.memory_bytes = std::uint64_t(gibibytes * (1 << 30));
    EXPECT_EQ(readahead_cells_for(options), ahead) << gibibytes;
  }
  options.cuda_device.reset();
  EXPECT_EQ(readahead_cells_for(options), 0u);
}

TEST(ImageBytes, AreASixteenthOfTheMemoryForAllWriters) {
  for (const std::uint64_t mebibytes : {64, 1024, 2048, 5000, 1 << 20}) {
    WorkerOptions options = beside_device(16);
    options.memory_bytes = mebibytes << 20;
    const std::uint64_t all = file_image_bytes_for(options) * std::uint64_t(writer_pool_size_for(options).writers);
    EXPECT_LE(all, options.memory_bytes / 16) << mebibytes;
    EXPECT_LE(all, std::uint64_t(256) << 20) << mebibytes;
  }
  EXPECT_EQ(file_image_bytes_for(beside_device(16)), std::uint64_t(64) << 20);
}

WorkerOptions without_device(int threads, std::uint64_t mebibytes) {
  WorkerOptions options;
  options.threads = threads;
  options.memory_bytes = mebibytes << 20;
  return options;
}

TEST(ConcurrentCells, AreOnePerTwoThreadsWhereMemorySuffices) {
  for (const auto& [threads, cells] : {std::pair(1, 1u), {2, 1u}, {3, 1u}, {4, 2u}, {16, 8u}, {128, 8u}})
    EXPECT_EQ(concurrent_cells_for(without_device(threads, 0)), cells) << threads;
  for (const auto& [mebibytes, cells] : {std::pair(64u, 1u), {2048u, 2u}, {4096u, 4u}, {65536u, 8u}})
    EXPECT_EQ(concurrent_cells_for(without_device(16, mebibytes)), cells) << mebibytes;
  EXPECT_EQ(concurrent_cells_for(beside_device(16)), 1u);
}

TEST(WriterPoolSize, IsTwoWritersAtMostWithoutADevice) {
  for (const auto& [threads, writers] : {std::pair(1, 1), {4, 1}, {6, 1}, {8, 2}, {64, 2}}) {
    EXPECT_EQ(writer_pool_size_for(without_device(threads, 0)).writers, writers) << threads;
    EXPECT_EQ(writer_pool_size_for(without_device(threads, 0)).threads, threads);
  }
}

}  // namespace
}  // namespace gigabake
