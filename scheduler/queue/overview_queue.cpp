#include "scheduler/queue/overview_queue.h"

#include <algorithm>

namespace gigabake {

OverviewQueue::OverviewQueue(const std::vector<CellJob>& jobs)
    : first_overview_(std::uint32_t(std::find_if(jobs.begin(), jobs.end(), is_overview) - jobs.begin())) {
  if (first_overview_ == jobs.size()) return;
  overviews_begin_.assign(jobs.size() + 1, 0);
  for (const CellJob& job : jobs)
    for (const std::uint32_t child : job.children) ++overviews_begin_.at(child + 1);
  for (std::size_t j = 0; j < jobs.size(); ++j) overviews_begin_[j + 1] += overviews_begin_[j];
  overviews_.resize(overviews_begin_.back());
  std::vector<std::uint32_t> at(overviews_begin_.begin(), overviews_begin_.end() - 1);
  for (std::uint32_t p = first_overview_; p < jobs.size(); ++p) {
    for (const std::uint32_t child : jobs[p].children) overviews_[at[child]++] = p;
    missing_.push_back(std::uint32_t(jobs[p].children.size()));
  }
  waiting_ = missing_.size();
  votes_.resize(missing_.size());
}

void OverviewQueue::settled(std::uint32_t job, std::optional<int> worker) {
  if (overviews_begin_.empty()) return;
  for (std::uint32_t i = overviews_begin_[job]; i < overviews_begin_[job + 1]; ++i) {
    Vote& vote = votes_[overviews_[i] - first_overview_];
    if (worker && vote.lead == 0) vote.worker = *worker;
    if (worker) vote.worker == *worker ? ++vote.lead : --vote.lead;
    std::uint32_t& missing = missing_[overviews_[i] - first_overview_];
    if (missing == taken || --missing != 0) continue;
    if (worker && vote.lead == 0) vote = {*worker, 1};
    ready_.push_back(overviews_[i]);
    --waiting_;
  }
}

void OverviewQueue::forget(int worker) {
  for (Vote& vote : votes_)
    if (vote.worker == worker) vote.lead = 0;
}

std::optional<std::uint32_t> OverviewQueue::choose(int worker) const {
  const auto found = std::find_if(ready_.begin(), ready_.end(), [&](std::uint32_t overview) {
    const Vote& vote = votes_[overview - first_overview_];
    return vote.lead == 0 || vote.worker == worker;
  });
  return found == ready_.end() ? std::nullopt : std::optional(*found);
}

void OverviewQueue::take(std::uint32_t overview) {
  std::uint32_t& missing = missing_[overview - first_overview_];
  if (missing == taken) return;
  if (missing != 0)
    --waiting_;
  else
    ready_.erase(std::find(ready_.begin(), ready_.end(), overview));
  missing = taken;
}

}  // namespace gigabake
