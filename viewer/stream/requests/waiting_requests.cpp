#include "viewer/stream/requests/waiting_requests.h"

#include <algorithm>
#include <atomic>
#include <utility>

namespace gigabake {
namespace {

/// The maximum number of entries before all requests are released, because obsolete requests keep their entries.
constexpr std::size_t max_groups = std::size_t(1) << 16, max_waiting = std::size_t(1) << 20;

bool is_loaded(const Pager& pager, const std::vector<PageKey>& pages) {
  return std::ranges::all_of(pages,
                             [&](const PageKey& page) { return pager.is_resident(page) || pager.is_damaged(page); });
}

}  // namespace

void WaitingRequests::clear() {
  groups_.clear();
  released_.clear();
  group_of_pages_.clear();
  group_of_request_.clear();
}

/// Forgets the group's requests. If all of them were forgotten together later, one pass would take much longer.
void WaitingRequests::release(std::uint32_t number) {
  for (const std::uint32_t request : groups_[number].requests) {
    const auto found = group_of_request_.find(request);
    if (found != group_of_request_.end() && found->second == number) group_of_request_.erase(found);
  }
  groups_[number] = {};
  released_.push_back(number);
}

void WaitingRequests::begin_pass(const Pager& pager) {
  if (groups_.size() > max_groups || group_of_request_.size() > max_waiting) clear();
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
  const auto found = group_of_request_.find(request);
  if (found == group_of_request_.end()) return false;
  Group& group = groups_[found->second];
  const std::atomic_ref<std::uint64_t> min_rank(group.rank);
  for (std::uint64_t before = min_rank.load(std::memory_order_relaxed); rank < before;)
    if (min_rank.compare_exchange_weak(before, rank, std::memory_order_relaxed)) break;
  return true;
}

void WaitingRequests::add(std::uint32_t request, std::uint64_t rank, std::vector<PageKey> missing) {
  std::ranges::sort(missing);
  const auto duplicates = std::ranges::unique(missing);
  missing.erase(duplicates.begin(), duplicates.end());
  const std::uint32_t next = released_.empty() ? std::uint32_t(groups_.size()) : released_.back();
  const auto [at, is_new] = group_of_pages_.try_emplace(std::move(missing), next);
  if (is_new) {
    if (released_.empty())
      groups_.emplace_back();
    else
      released_.pop_back();
    groups_[next].pages = at->first;
  }
  Group& group = groups_[at->second];
  group.rank = std::min(group.rank, rank);
  const auto [entry, is_added] = group_of_request_.try_emplace(request, at->second);
  if (!is_added && entry->second == at->second) return;
  entry->second = at->second;
  group.requests.push_back(request);
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
