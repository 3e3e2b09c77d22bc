#include "viewer/stream/requests/waiting_requests.h"

#include <algorithm>
#include <atomic>
#include <utility>

namespace gigabake {
namespace {

/// The maximum number of groups before all requests are released, because obsolete requests keep their groups.
constexpr std::size_t max_groups = std::size_t(1) << 16;

bool is_loaded(const Pager& pager, const std::vector<PageKey>& pages) {
  return std::ranges::all_of(pages,
                             [&](const PageKey& page) { return pager.is_resident(page) || pager.is_damaged(page); });
}

bool is_sorted_unique(const std::vector<PageKey>& pages) {
  return std::ranges::adjacent_find(pages, [](const PageKey& a, const PageKey& b) { return !(a < b); }) == pages.end();
}

}  // namespace

void sort_unique(std::vector<PageKey>& pages) {
  if (is_sorted_unique(pages)) return;
  std::ranges::sort(pages);
  const auto duplicates = std::ranges::unique(pages);
  pages.erase(duplicates.begin(), duplicates.end());
}

void WaitingRequests::clear() {
  groups_.clear();
  released_.clear();
  group_of_pages_.clear();
  group_of_request_.clear();
}

/// Forgets the group's requests. If all of them were forgotten together later, one pass would take much longer.
void WaitingRequests::release(std::uint32_t number) {
  for (const std::uint32_t request : groups_[number].requests) {
    if (group_of_request_[request] == number + 1) group_of_request_[request] = 0;
  }
  groups_[number] = {};
  released_.push_back(number);
}

void WaitingRequests::begin_pass(const Pager& pager) {
  if (groups_.size() > max_groups) clear();
  for (auto at = group_of_pages_.begin(); at != group_of_pages_.end();) {
    Group& group = groups_[at->second];
    group.rank = no_rank;
    if (is_loaded(pager, group.pages)) {
      release(at->second);
      at = group_of_pages_.erase(at);
    } else {
      ++at;
    }
  }
}

bool WaitingRequests::waits(std::uint32_t request, std::uint64_t rank) {
  const std::uint32_t number = group_of_request_.at(request);
  if (number == 0) return false;
  Group& group = groups_[number - 1];
  const std::atomic_ref<std::uint64_t> min_rank(group.rank);
  for (std::uint64_t before = min_rank.load(std::memory_order_relaxed); rank < before;)
    if (min_rank.compare_exchange_weak(before, rank, std::memory_order_relaxed)) break;
  return true;
}

/// Returns the group of requests that lack these pages. Adds one if there is none.
std::uint32_t WaitingRequests::group_for(const std::vector<PageKey>& pages) {
  if (latest_ < groups_.size() && groups_[latest_].pages == pages) return latest_;
  const std::uint32_t next = released_.empty() ? std::uint32_t(groups_.size()) : released_.back();
  const auto [at, is_new] = group_of_pages_.try_emplace(pages, next);
  latest_ = at->second;
  if (!is_new) return latest_;
  if (released_.empty())
    groups_.emplace_back();
  else
    released_.pop_back();
  groups_[next].pages = pages;
  return latest_;
}

void WaitingRequests::add(std::uint32_t request, std::uint64_t rank, const std::vector<PageKey>& missing) {
  if (!is_sorted_unique(missing)) {
    std::vector<PageKey> sorted = missing;
    sort_unique(sorted);
    return add(request, rank, sorted);
  }
  const std::uint32_t number = group_for(missing);
  Group& group = groups_[number];
  group.rank = std::min(group.rank, rank);
  if (std::exchange(group_of_request_[request], number + 1) != number + 1) group.requests.push_back(request);
}

std::vector<PageKey> WaitingRequests::pages_by_urgency() const {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted;
  for (const auto& [pages, number] : group_of_pages_)
    if (groups_[number].rank != no_rank) sorted.emplace_back(groups_[number].rank, number);
  std::ranges::sort(sorted);
  std::vector<PageKey> pages;
  for (const auto& [rank, number] : sorted)
    pages.insert(pages.end(), groups_[number].pages.begin(), groups_[number].pages.end());
  return pages;
}

}  // namespace gigabake
