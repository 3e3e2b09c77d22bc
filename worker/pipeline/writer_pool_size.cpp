#include "worker/pipeline/writer_pool_size.h"

#include <algorithm>
#include <cstdint>

namespace gigabake {

WriterPoolSize writer_pool_size_for(const WorkerOptions& options) {
  constexpr std::uint64_t bytes_a_writer = std::uint64_t(512) << 20, min_writers = 2, max_writers = 4;
  constexpr int others = 4;  // reader, compute and readback threads, which mostly wait
  if (!options.cuda_device) return {concurrent_cells_for(options) < 4 ? 1 : 2, options.threads};
  const std::uint64_t by_memory = options.memory_bytes == 0 ? max_writers : options.memory_bytes / bytes_a_writer,
                      by_threads = std::uint64_t(options.threads / 2);
  const int writers = int(std::clamp(std::min(by_threads, by_memory), min_writers, max_writers));
  return {writers, std::max(1, options.threads - writers - others + 1)};
}

std::size_t concurrent_cells_for(const WorkerOptions& options) {
  constexpr std::uint64_t bytes_a_cell = std::uint64_t(1) << 30, maximum = 8;
  if (options.cuda_device) return 1;
  const std::uint64_t by_memory = options.memory_bytes == 0 ? maximum : options.memory_bytes / bytes_a_cell,
                      by_threads = std::uint64_t(options.threads / 2);
  return std::size_t(std::clamp<std::uint64_t>(std::min(by_threads, by_memory), 1, maximum));
}

std::size_t readers_for(const WorkerOptions& options) {
  constexpr std::uint64_t bytes_a_reader = std::uint64_t(2) << 30, threads_a_reader = 4, maximum = 3;
  if (!options.cuda_device && !options.stored_only) return 1;
  const std::uint64_t by_memory = options.memory_bytes == 0 ? maximum : options.memory_bytes / bytes_a_reader,
                      by_threads = std::uint64_t(options.threads) / threads_a_reader;
  return std::size_t(std::clamp<std::uint64_t>(std::min(by_threads, by_memory), 1, maximum));
}

std::size_t readahead_cells_for(const WorkerOptions& options) {
  constexpr std::uint64_t bytes_a_cell = std::uint64_t(1) << 30, maximum = 3;
  if (!options.cuda_device) return 0;
  return std::size_t(options.memory_bytes == 0 ? maximum : std::min(maximum, options.memory_bytes / bytes_a_cell));
}

std::size_t overview_makers_for(const WorkerOptions& options) {
  constexpr int threads_a_maker = 4, maximum = 4;
  return std::size_t(std::clamp(options.threads / threads_a_maker, 1, maximum));
}

std::uint64_t file_image_bytes_for(const WorkerOptions& options) {
  constexpr std::uint64_t maximum = std::uint64_t(64) << 20;
  if (options.memory_bytes == 0) return maximum;
  return std::min(maximum, options.memory_bytes / 16 / std::uint64_t(writer_pool_size_for(options).writers));
}

}  // namespace gigabake
