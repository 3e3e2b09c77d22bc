#include "worker/write_crew.h"

#include <algorithm>
#include <cstdint>

namespace gigabake {

WriteCrew write_crew_for(const WorkerOptions& options) {
  constexpr std::uint64_t bytes_a_writer = std::uint64_t(512) << 20, least_writers = 2, most_writers = 4;
  constexpr int others = 4;  // reader, compute and readback threads, which mostly wait
  if (!options.cuda_device) return {1, options.threads};
  const std::uint64_t by_memory = options.memory_bytes == 0 ? most_writers : options.memory_bytes / bytes_a_writer,
                      by_threads = std::uint64_t(options.threads / 2);
  const int writers = int(std::clamp(std::min(by_threads, by_memory), least_writers, most_writers));
  return {writers, std::max(1, options.threads - writers - others + 1)};
}

std::size_t cells_ahead_for(const WorkerOptions& options) {
  constexpr std::uint64_t bytes_a_cell = std::uint64_t(1) << 30, most = 3;
  if (!options.cuda_device) return 0;
  return std::size_t(options.memory_bytes == 0 ? most : std::min(most, options.memory_bytes / bytes_a_cell));
}

std::size_t overview_makers_for(const WorkerOptions& options) {
  constexpr int threads_a_maker = 4, most = 4;
  return std::size_t(std::clamp(options.threads / threads_a_maker, 1, most));
}

std::uint64_t image_bytes_for(const WorkerOptions& options) {
  constexpr std::uint64_t most = std::uint64_t(64) << 20;
  if (options.memory_bytes == 0) return most;
  return std::min(most, options.memory_bytes / 16 / std::uint64_t(write_crew_for(options).writers));
}

}  // namespace gigabake
