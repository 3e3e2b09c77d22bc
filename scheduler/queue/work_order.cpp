#include "scheduler/queue/work_order.h"

#include <algorithm>
#include <bit>
#include <tuple>

#include "core/octree/morton.h"
#include "scheduler/plan/estimate.h"

namespace gigabake {
namespace {

/// Max number of waiting cells that are examined on each side of the last cell on the curve.
constexpr int looked_at = 4;

/// Returns the cost class. The classes begin at costs 0, 1, 2, 3, 4, 6, 8, 12 and so on. Integer arithmetic makes every
/// machine sort equally.
int cost_class(std::uint64_t cost) {
  const int width = int(std::bit_width(cost));
  return width < 2 ? width : 2 * width + int(cost >> (width - 2) & 1);
}

/// Returns the Morton code of a cell's column. Columns 2^32 apart have equal codes; this affects only the order of
/// dispatch.
std::uint64_t place_of(const CellJob& job) {
  const auto column = [&job](std::size_t axis) {
    const std::int64_t index = job.lattice_min[axis] / std::max<std::int64_t>(1, job.cell_voxels);
    return std::uint32_t(index) ^ 0x80000000u;
  };
  return morton(column(0), column(1));
}

std::size_t shared_tiles(const CellJob& a, const CellJob& b) {
  std::size_t shared = 0;
  for (auto i = a.tiles.begin(), j = b.tiles.begin(); i != a.tiles.end() && j != b.tiles.end();) {
    if (*i == *j)
      ++shared, ++i, ++j;
    else if (*i < *j)
      ++i;
    else
      ++j;
  }
  return shared;
}

/// Returns element `number` of the van der Corput sequence 0, 1/2, 1/4, 3/4, 1/8, … times `size`. Any prefix of the
/// sequence is evenly spread.
std::uint32_t van_der_corput(std::uint32_t number, std::uint32_t size) {
  std::uint64_t reversed = 0;
  for (int bit = 0; bit < 32; ++bit) reversed |= std::uint64_t(number >> bit & 1) << (31 - bit);
  return std::uint32_t(reversed * size >> 32);
}

}  // namespace

WorkOrder::WorkOrder(const std::vector<CellJob>& jobs)
    : jobs_(jobs), job_(jobs.size()), rank_(jobs.size()), place_(jobs.size()), waiting_(std::uint32_t(jobs.size())) {
  struct Key {
    std::uint64_t place;
    std::uint32_t job;
    int cost_class;
  };
  std::vector<Key> keys(jobs.size());
  for (std::uint32_t j = 0; j < keys.size(); ++j) keys[j] = {place_of(jobs[j]), j, cost_class(cell_cost(jobs[j]))};
  std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
    return std::tie(b.cost_class, a.place, a.job) < std::tie(a.cost_class, b.place, b.job);
  });
  for (std::uint32_t r = 0; r < keys.size(); ++r) {
    job_[r] = keys[r].job;
    rank_[keys[r].job] = r;
    place_[r] = keys[r].place;
    if (r + 1 == keys.size() || keys[r + 1].cost_class != keys[r].cost_class) class_end_.push_back(r + 1);
  }
}

WorkOrder::Class WorkOrder::class_of(std::uint32_t rank) const {
  const auto end = std::upper_bound(class_end_.begin(), class_end_.end(), rank);
  return {end == class_end_.begin() ? 0 : end[-1], *end};
}

std::optional<std::uint32_t> WorkOrder::choose(std::optional<std::uint32_t> last) {
  const auto first = waiting_.at_or_after(0);
  if (!first) return std::nullopt;
  const Class c = class_of(*first);
  std::optional<std::uint32_t> rank;
  if (last) rank = neighbour(c, *last);
  if (!rank) rank = new_start(c);
  return job_[*rank];
}

/// Returns the rank of a waiting job of the class: the first from the next van der Corput position on, else the first
/// of all.
/// Range   The class has a waiting job.
std::uint32_t WorkOrder::new_start(const Class& c) {
  const auto found = waiting_.at_or_after(c.begin + van_der_corput(new_starts_++, c.end - c.begin));
  return found && *found < c.end ? *found : *waiting_.at_or_after(c.begin);
}

/// Returns the rank of a waiting cell near `last` on the curve: the cell that shares the most tiles with `last`, then
/// the nearest. Returns nullopt if no examined cell shares a tile.
std::optional<std::uint32_t> WorkOrder::neighbour(const Class& c, std::uint32_t last) const {
  const std::uint64_t here = place_[rank_[last]];
  const auto at = [this](std::uint32_t rank) { return place_.begin() + std::ptrdiff_t(rank); };
  const auto middle = std::uint32_t(std::lower_bound(at(c.begin), at(c.end), here) - place_.begin());
  std::optional<std::uint32_t> best;
  std::size_t maximum = 0;
  std::uint64_t nearest = 0;
  const auto consider = [&](std::uint32_t rank) {
    const std::uint64_t away = place_[rank] < here ? here - place_[rank] : place_[rank] - here;
    const std::size_t shared = shared_tiles(jobs_[last], jobs_[job_[rank]]);
    if (shared < std::max<std::size_t>(1, maximum) || (shared == maximum && away >= nearest)) return;
    best = rank, maximum = shared, nearest = away;
  };
  auto up = waiting_.at_or_after(middle);
  for (int i = 0; i < looked_at && up && *up < c.end; ++i, up = waiting_.at_or_after(*up + 1)) consider(*up);
  auto down = waiting_.before(middle);
  for (int i = 0; i < looked_at && down && *down >= c.begin; ++i, down = waiting_.before(*down)) consider(*down);
  return best;
}

}  // namespace gigabake
