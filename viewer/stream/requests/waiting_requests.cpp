#include "viewer/stream/requests/waiting_requests.h"

#include <algorithm>
#include <atomic>
#include <utility>

namespace gigabake {
namespace {

/// The maximum number of entries before all requests are released, because released groups and obsolete requests keep
/// their entries.
constexpr std::size_t max_groups = std::size_t(1) << 16, max_waiting = std::size_t(1) << 20;

bool is_loaded(const Pager& pager, const std::vector<PageKey>& pages) {
  return std::ranges::all_of(pages,
                             [&](const PageKey& page) { return pager.is_resident(page) || pager.is_damaged(page); });
}

}  // namespace

void WaitingRequests::clear() {
  groups_.clear();
  group_of_pages_.clear();
  group_of_request_.clear();
}

void WaitingRequests::begin_pass(const Pager& pager) {
  if (groups_.size() > max_groups || group_of_request_.size() > max_waiting) clear();
  for (auto at = group_of_pages_.begin(); at != group_of_pages_.end();) {
    Group& group = groups_[at->second];
    group.rank = no_rank;
    if (is_loaded(pager, group.pages)) {
      group.pages.clear();
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
  if (group.pages.empty()) return false;
  const std::atomic_ref<std::uint64_t> min_rank(group.rank);
  for (std::uint64_t before = min_rank.load(std::memory_order_relaxed); rank < before;)
    if (min_rank.compare_exchange_weak(before, rank, std::memory_order_relaxed)) break;
  return true;
}

void WaitingRequests::add(std::uint32_t request, std::uint64_t rank, std::vector<PageKey> missing) {
  std::ranges::sort(missing);
  const auto duplicates = std::ranges::unique(missing);
  missing.erase(duplicates.begin(), duplicates.end());
  const auto [at, is_new] = group_of_pages_.try_emplace(std::move(missing), std::uint32_t(groups_.size()));
  if (is_new) groups_.push_back({at->first});
  Group& group = groups_[at->second];
  group.rank = std::min(group.rank, rank);
  group_of_request_[request] = at->second;
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
