#include "scheduler/queue/work_order.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/octree/morton.h"
#include "scheduler/plan/estimate.h"

namespace gigabake {
namespace {

/// Max number of waiting cells that are examined on each side of the last cell on the curve.
constexpr int looked_at = 4;
/// Cells of a lower class than this multiple of the mean cost are ordinary: they may be dispatched in any order.
constexpr std::uint64_t expensive_multiple_of_mean = 2;
/// Max number of the most expensive waiting cells that are examined for a cell that the worker has claimed.
constexpr int examined_at_the_end = 16;

/// Returns the cost class. The classes begin at costs 0, 1, 2, 3, 4, 6, 8, 12 and so on. Integer arithmetic makes every
/// machine sort equally.
int cost_class(std::uint64_t cost) {
  const int width = int(std::bit_width(cost));
  return width < 2 ? width : 2 * width + int(cost >> (width - 2) & 1);
}

std::uint64_t mean_cost_of_cells(const std::vector<CellJob>& jobs) {
  std::uint64_t sum = 0, cells = 0;
  for (const CellJob& job : jobs)
    if (!is_overview(job)) sum += cell_cost(job), ++cells;
  return cells == 0 ? 0 : sum / cells;
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

/// Returns the first overview of the group of `overview`, and shortens the path to it.
std::uint32_t first_of_group(std::vector<std::uint32_t>& group, std::uint32_t overview) {
  while (group[overview] != overview) overview = group[overview] = group[group[overview]];
  return overview;
}

}  // namespace

void WorkOrder::Sequence::assign(std::vector<std::uint32_t> sorted_jobs, std::size_t all_jobs) {
  job = std::move(sorted_jobs);
  rank.assign(all_jobs, none);
  for (std::uint32_t r = 0; r < job.size(); ++r) rank[job[r]] = r;
  waiting = IndexSet(std::uint32_t(job.size()));
}

bool WorkOrder::Candidate::is_better_than(const Candidate& other) const {
  return std::tie(claim, shared_tiles, other.distance) > std::tie(other.claim, other.shared_tiles, distance);
}

WorkOrder::WorkOrder(const std::vector<CellJob>& jobs) : jobs_(jobs), mean_cost_(mean_cost_of_cells(jobs)) {
  std::vector<std::uint32_t> ordinary;
  std::vector<int> class_of_job;
  const int expensive = cost_class(expensive_multiple_of_mean * mean_cost_);
  for (std::uint32_t j = 0; j < jobs.size(); ++j) {
    place_.push_back(place_of(jobs[j]));
    class_of_job.push_back(cost_class(cell_cost(jobs[j])));
    if (!is_overview(jobs[j]) && class_of_job[j] < expensive) ordinary.push_back(j);
  }
  std::stable_sort(ordinary.begin(), ordinary.end(),
                   [this](std::uint32_t a, std::uint32_t b) { return place_[a] < place_[b]; });
  ordinary_.assign(std::move(ordinary), jobs.size());
  sort_by_cost(class_of_job);
  find_groups();
}

void WorkOrder::sort_by_cost(const std::vector<int>& class_of_job) {
  std::vector<std::uint32_t> sorted(jobs_.size());
  std::iota(sorted.begin(), sorted.end(), 0u);
  std::sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(class_of_job[b], place_[a], a) < std::tie(class_of_job[a], place_[b], b);
  });
  for (std::uint32_t r = 0; r < sorted.size(); ++r)
    if (r + 1 == sorted.size() || class_of_job[sorted[r + 1]] != class_of_job[sorted[r]]) class_end_.push_back(r + 1);
  by_cost_.assign(std::move(sorted), jobs_.size());
}

/// Finds the group of each cell, and the first ordinary cell of each group.
void WorkOrder::find_groups() {
  const auto first = std::uint32_t(std::find_if(jobs_.begin(), jobs_.end(), is_overview) - jobs_.begin());
  const std::uint32_t overviews = std::uint32_t(jobs_.size()) - first;
  std::vector<std::uint32_t> group(overviews);
  std::iota(group.begin(), group.end(), 0u);
  group_.assign(jobs_.size(), none);
  for (std::uint32_t o = 0; o < overviews; ++o)
    for (const std::uint32_t child : jobs_[first + o].children) {
      if (child >= first) continue;
      if (group_[child] == none) group_[child] = o;
      const std::uint32_t a = first_of_group(group, o), b = first_of_group(group, group_[child]);
      group[std::max(a, b)] = std::min(a, b);
    }
  claimed_by_.assign(overviews, unclaimed);
  first_cell_.assign(overviews, none);
  for (std::uint32_t cell = 0; cell < first; ++cell) {
    if (group_[cell] == none) continue;
    group_[cell] = first_of_group(group, group_[cell]);
    first_cell_[group_[cell]] = std::min(first_cell_[group_[cell]], ordinary_.rank[cell]);
  }
  unclaimed_ = IndexSet(overviews);
  for (std::uint32_t o = 0; o < overviews; ++o)
    if (first_cell_[o] == none) unclaimed_.erase(o);
}

void WorkOrder::take(std::uint32_t job) {
  by_cost_.waiting.erase(by_cost_.rank[job]);
  if (ordinary_.rank[job] != none) ordinary_.waiting.erase(ordinary_.rank[job]);
}

void WorkOrder::claim(std::uint32_t job, int worker) {
  const std::uint32_t group = group_[job];
  if (group == none || claimed_by_[group] != unclaimed) return;
  claimed_by_[group] = worker;
  unclaimed_.erase(group);
}

WorkOrder::Claim WorkOrder::claim_of(std::uint32_t job, int worker) const {
  const std::uint32_t group = group_[job];
  if (group == none || claimed_by_[group] == unclaimed) return Claim::none;
  return claimed_by_[group] == worker ? Claim::own : Claim::others;
}

WorkOrder::Range WorkOrder::class_of(std::uint32_t rank) const {
  const auto end = std::upper_bound(class_end_.begin(), class_end_.end(), rank);
  return {by_cost_, end == class_end_.begin() ? 0 : end[-1], *end};
}

std::optional<std::uint32_t> WorkOrder::choose(int worker, std::optional<std::uint32_t> last, bool is_ending) {
  const auto first = by_cost_.waiting.at_or_after(0);
  if (!first) return std::nullopt;
  const bool is_expensive = ordinary_.rank[by_cost_.job[*first]] == none;
  if (is_ending && !is_expensive) return choose_expensive(worker);
  const Range range = is_expensive ? class_of(*first) : Range{ordinary_, 0, std::uint32_t(ordinary_.job.size())};
  const std::optional<Candidate> near = last ? neighbour(range, *last, worker) : std::nullopt;
  if (near && near->claim != Claim::others) return near->job;
  if (const auto start = is_expensive ? std::nullopt : unclaimed_start()) return start;
  return near ? near->job : new_start(range);
}

/// Returns one of the most expensive waiting cells: the first that the worker has claimed, else the first unclaimed
/// cell, else the first.
std::uint32_t WorkOrder::choose_expensive(int worker) const {
  auto next = by_cost_.waiting.at_or_after(0);
  std::uint32_t best = by_cost_.job[*next];
  for (int i = 0; i < examined_at_the_end && next; ++i, next = by_cost_.waiting.at_or_after(*next + 1)) {
    const std::uint32_t job = by_cost_.job[*next];
    if (claim_of(job, worker) > claim_of(best, worker)) best = job;
  }
  return best;
}

/// Returns the first waiting cell of an unclaimed group. Returns nullopt if all groups are claimed.
std::optional<std::uint32_t> WorkOrder::unclaimed_start() {
  if (!unclaimed_.at_or_after(0)) return std::nullopt;
  const auto found = unclaimed_.at_or_after(van_der_corput(new_starts_++, std::uint32_t(first_cell_.size())));
  const auto rank = ordinary_.waiting.at_or_after(first_cell_[found ? *found : *unclaimed_.at_or_after(0)]);
  return rank ? std::optional(ordinary_.job[*rank]) : std::nullopt;
}

/// Returns a waiting job of the range: the first from the next van der Corput position on, else the first of all.
/// Range   The range has a waiting job.
std::uint32_t WorkOrder::new_start(const Range& range) {
  const IndexSet& waiting = range.sequence.waiting;
  const auto found = waiting.at_or_after(range.begin + van_der_corput(new_starts_++, range.end - range.begin));
  return range.sequence.job[found && *found < range.end ? *found : *waiting.at_or_after(range.begin)];
}

/// Returns the best waiting cell near `last` on the curve. Returns nullopt if no examined cell shares a tile with
/// `last` or is claimed by the worker.
std::optional<WorkOrder::Candidate> WorkOrder::neighbour(const Range& range, std::uint32_t last, int worker) const {
  const Sequence& sequence = range.sequence;
  const auto at = [&](std::uint32_t rank) { return sequence.job.begin() + std::ptrdiff_t(rank); };
  const std::uint64_t here = place_[last];
  const auto middle =
      std::uint32_t(std::lower_bound(at(range.begin), at(range.end), here,
                                     [this](std::uint32_t job, std::uint64_t place) { return place_[job] < place; }) -
                    sequence.job.begin());
  std::optional<Candidate> best;
  const auto consider = [&](std::uint32_t rank) {
    const std::uint32_t job = sequence.job[rank];
    const std::uint64_t there = place_[job];
    const Candidate next{claim_of(job, worker), shared_tiles(jobs_[last], jobs_[job]),
                         there < here ? here - there : there - here, job};
    if (next.claim != Claim::own && next.shared_tiles == 0) return;
    if (!best || next.is_better_than(*best)) best = next;
  };
  const IndexSet& waiting = sequence.waiting;
  auto up = waiting.at_or_after(middle);
  for (int i = 0; i < looked_at && up && *up < range.end; ++i, up = waiting.at_or_after(*up + 1)) consider(*up);
  auto down = waiting.before(middle);
  for (int i = 0; i < looked_at && down && *down >= range.begin; ++i, down = waiting.before(*down)) consider(*down);
  return best;
}

}  // namespace gigabake
