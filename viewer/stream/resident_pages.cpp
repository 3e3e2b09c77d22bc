#include "viewer/stream/resident_pages.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace gigabake {

std::size_t PageKeyHash::operator()(const PageKey& key) const {
  const std::uint64_t place = std::uint64_t(key.shard) << 32 | key.block;
  const std::uint64_t mixed = (place ^ std::uint64_t(key.part + 1) << 58) * 0x9e3779b97f4a7c15u;
  return std::size_t(mixed ^ mixed >> 32);
}

const Page* ResidentPages::find(const PageKey& key) const {
  const auto found = residents_.find(key);
  if (found == residents_.end()) return nullptr;
  const Resident& resident = found->second;
  std::uint64_t used = resident.used.load(std::memory_order_relaxed);
  while (used != evicted && used != pass_)
    if (resident.used.compare_exchange_weak(used, pass_, std::memory_order_relaxed)) return &resident.page;
  return used == evicted ? nullptr : &resident.page;
}

bool ResidentPages::has(const PageKey& key) const {
  const auto found = residents_.find(key);
  return found != residents_.end() && found->second.used.load(std::memory_order_relaxed) != evicted;
}

void ResidentPages::begin_pass() {
  for (const PageKey& key : evicted_) residents_.erase(key);
  evicted_.clear();
  ++pass_;
}

void ResidentPages::add(const PageKey& key, Page page, std::uint64_t page_bytes) {
  residents_.try_emplace(key, std::move(page), page_bytes, pass_ - 1);
  bytes_ += page_bytes;
}

bool ResidentPages::is_more_recent(const Candidate& a, const Candidate& b) {
  return std::tie(a.used, a.key) > std::tie(b.used, b.key);
}

void ResidentPages::list_none() {
  candidates_.clear();
  candidate_bytes_ = 0;
}

void ResidentPages::list_unused() {
  list_none();
  for (auto& [key, resident] : residents_) {
    const std::uint64_t used = resident.used.load(std::memory_order_relaxed);
    if (used == evicted || used == pass_) continue;
    candidates_.push_back({used, key, &resident});
    candidate_bytes_ += resident.bytes;
  }
  std::make_heap(candidates_.begin(), candidates_.end(), is_more_recent);
}

void ResidentPages::evict(std::uint64_t bytes) {
  while (bytes_ > bytes && !candidates_.empty()) {
    std::pop_heap(candidates_.begin(), candidates_.end(), is_more_recent);
    Candidate candidate = candidates_.back();
    candidates_.pop_back();
    Resident& resident = *candidate.resident;
    candidate_bytes_ -= resident.bytes;
    if (!resident.used.compare_exchange_strong(candidate.used, evicted, std::memory_order_relaxed)) continue;
    bytes_ -= resident.bytes;
    resident.page = {};
    evicted_.push_back(candidate.key);
    last_eviction_ = std::max<std::uint64_t>(pass_, 1);
  }
}

}  // namespace gigabake
