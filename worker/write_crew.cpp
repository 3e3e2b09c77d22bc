#include "worker/write_crew.h"

#include <algorithm>
#include <cstdint>

namespace gigabake {

WriteCrew write_crew_for(const WorkerOptions& options) {
  constexpr std::uint64_t bytes_a_writer = std::uint64_t(512) << 20;
  constexpr int least_writers = 2, most_writers = 8, others = 4;  // who read, compute and download
  if (!options.cuda_device) return {1, options.threads};
  const std::uint64_t room = options.memory_bytes == 0 ? most_writers : options.memory_bytes / bytes_a_writer;
  const int most = int(std::min<std::uint64_t>(room, most_writers));
  const int writers = std::max(least_writers, std::min(options.threads / 2, most));
  return {writers, std::max(1, options.threads - writers - others + 1)};
}

}  // namespace gigabake
