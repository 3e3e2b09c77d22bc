#include "scheduler/cell_queue.h"

#include <algorithm>
#include <numeric>

namespace gigabake {
namespace {

/// A cell of at least this share of the largest may be taken before it. Few enough are looked at to stay cheap.
constexpr double near_enough_in_size = 0.5;
constexpr std::size_t most_candidates = 64;

}  // namespace

CellQueue::CellQueue(const std::vector<CellJob>& jobs) : jobs_(jobs), order_(jobs.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  std::stable_sort(order_.begin(), order_.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return jobs_[a].triangles < jobs_[b].triangles; });
}

double CellQueue::distance(std::uint32_t a, std::uint32_t b) const {
  double d = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double step = double(jobs_[a].lattice_min[c] - jobs_[b].lattice_min[c]);
    d += step * step;
  }
  return d;
}

std::optional<std::uint32_t> CellQueue::next(std::optional<std::uint32_t> last) {
  if (order_.empty()) return std::nullopt;
  std::size_t best = order_.size() - 1;
  if (last) {
    const double enough = near_enough_in_size * double(jobs_[order_.back()].triangles);
    const std::size_t lowest = order_.size() > most_candidates ? order_.size() - most_candidates : 0;
    for (std::size_t i = order_.size() - 1; i-- > lowest && double(jobs_[order_[i]].triangles) >= enough;)
      if (distance(order_[i], *last) < distance(order_[best], *last)) best = i;
  }
  const std::uint32_t job = order_[best];
  order_.erase(order_.begin() + std::ptrdiff_t(best));
  return job;
}

}  // namespace gigabake
