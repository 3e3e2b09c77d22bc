#include "core/base/work_counts.h"

#include <atomic>

namespace gigabake {
namespace {

std::array<std::atomic<std::uint64_t>, names_of<WorkCounter>().size()> process_counts{};

}  // namespace

WorkCounts& WorkCounts::operator+=(const WorkCounts& other) {
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += other.counts[i];
  return *this;
}

WorkCounts WorkCounts::since(const WorkCounts& earlier) const {
  WorkCounts difference;
  for (std::size_t i = 0; i < counts.size(); ++i) difference.counts[i] = counts[i] - earlier.counts[i];
  return difference;
}

void count_work(WorkCounter counter, std::uint64_t amount) noexcept {
  process_counts[std::size_t(counter)].fetch_add(amount, std::memory_order_relaxed);
}

WorkCounts work_counts() noexcept {
  WorkCounts now;
  for (std::size_t i = 0; i < now.counts.size(); ++i) now.counts[i] = process_counts[i].load(std::memory_order_relaxed);
  return now;
}

}  // namespace gigabake
