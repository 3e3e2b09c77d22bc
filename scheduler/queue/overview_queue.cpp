#include "scheduler/queue/overview_queue.h"

#include <algorithm>

namespace gigabake {

OverviewQueue::OverviewQueue(const std::vector<CellJob>& jobs)
    : first_parent_(std::uint32_t(std::find_if(jobs.begin(), jobs.end(), is_parent) - jobs.begin())) {
  if (first_parent_ == jobs.size()) return;
  parents_begin_.assign(jobs.size() + 1, 0);
  for (const CellJob& job : jobs)
    for (const std::uint32_t child : job.children) ++parents_begin_.at(child + 1);
  for (std::size_t j = 0; j < jobs.size(); ++j) parents_begin_[j + 1] += parents_begin_[j];
  parents_.resize(parents_begin_.back());
  std::vector<std::uint32_t> at(parents_begin_.begin(), parents_begin_.end() - 1);
  for (std::uint32_t p = first_parent_; p < jobs.size(); ++p) {
    for (const std::uint32_t child : jobs[p].children) parents_[at[child]++] = p;
    missing_.push_back(std::uint32_t(jobs[p].children.size()));
  }
  waiting_ = missing_.size();
}

void OverviewQueue::settled(std::uint32_t job, std::optional<int> worker) {
  if (parents_begin_.empty()) return;
  for (std::uint32_t i = parents_begin_[job]; i < parents_begin_[job + 1]; ++i) {
    std::uint32_t& missing = missing_[parents_[i] - first_parent_];
    if (missing == taken || --missing != 0) continue;
    ready_.push_back({parents_[i], worker});
    --waiting_;
  }
}

std::optional<std::uint32_t> OverviewQueue::choose(int worker) const {
  if (ready_.empty()) return std::nullopt;
  const auto own = std::find_if(ready_.begin(), ready_.end(), [worker](const Ready& r) { return r.worker == worker; });
  return own == ready_.end() ? ready_.front().parent : own->parent;
}

void OverviewQueue::take(std::uint32_t parent) {
  std::uint32_t& missing = missing_[parent - first_parent_];
  if (missing == taken) return;
  if (missing != 0)
    --waiting_;
  else
    ready_.erase(std::find_if(ready_.begin(), ready_.end(), [parent](const Ready& r) { return r.parent == parent; }));
  missing = taken;
}

}  // namespace gigabake
