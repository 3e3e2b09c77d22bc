#include "worker/write_crew.h"

#include <algorithm>
#include <cstdint>

namespace gigabake {

WriteCrew write_crew_for(const WorkerOptions& options) {
  constexpr std::uint64_t short_of_memory = std::uint64_t(2) << 30;
  constexpr int most_writers = 8, others = 4;  // who read, compute and download
  if (!options.cuda_device) return {1, options.threads};
  const bool is_short = options.memory_bytes != 0 && options.memory_bytes < short_of_memory;
  const int writers = is_short ? 2 : std::clamp(options.threads / 2, 2, most_writers);
  return {writers, std::max(1, options.threads - writers - others + 1)};
}

}  // namespace gigabake
