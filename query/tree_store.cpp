#include "query/tree_store.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"
#include "core/base/memory_limit.h"

namespace gigabake {

TreeStore::TreeStore(NumberedShards& numbers, std::uint64_t memory_bytes, const ThreadPool& pool)
    : numbers_(numbers), memory_bytes_(memory_bytes), pool_(pool) {}

TreeStore::Found TreeStore::find(const QueryTreeKey& key) const {
  const auto found = entries_.find(key);
  if (found == entries_.end()) return {};
  const Entry& entry = found->second;
  if (entry.used.load(std::memory_order_relaxed) != pass_) entry.used.store(pass_, std::memory_order_relaxed);
  return {entry.tree.get(), entry.tree == nullptr};
}

void TreeStore::tell(const std::string& problem) {
  if (std::find(problems_.begin(), problems_.end(), problem) == problems_.end()) problems_.push_back(problem);
}

/// Evicts the least recently used trees until `bytes` fit or no tree may be evicted.
void TreeStore::make_room(std::uint64_t bytes, Evict evict) {
  std::vector<std::pair<std::uint64_t, QueryTreeKey>> oldest;
  for (const auto& [key, entry] : entries_)
    if (entry.tree != nullptr && (evict == Evict::any || entry.used != pass_)) oldest.push_back({entry.used, key});
  std::sort(oldest.begin(), oldest.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [used, key] : oldest) {
    if (bytes_ + bytes <= memory_bytes_) return;
    const auto gone = entries_.find(key);
    bytes_ -= gone->second.bytes;
    entries_.erase(gone);
  }
}

void TreeStore::open(std::vector<Building>& all) const {
  pool_.parallel_for(all.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      Building& b = all[i];
      try {
        b.source = std::make_unique<QueryTreeSource>(numbers_.scene(), b.shard, b.key.lod);
        b.bytes = b.source->bytes_to_build();
      } catch (const InputError& error) {
        b.problem = error.what();
      }
    }
  });
}

/// Returns the number of trees of `all`, from the first on, that fit into the memory after evictions. If `must` is
/// true, any resident tree may be evicted for the first tree of `all`.
std::size_t TreeStore::admit(std::vector<Building>& all, bool must) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::uint64_t more = all[i].bytes;
    if (more > memory_bytes_)
      throw UsageError("memory_bytes", "level " + std::to_string(all[i].key.lod) + " of cell " + all[i].shard.name +
                                           " needs " + readable_size(more) +
                                           "; expected at least that much, or a coarser lod");
    const bool is_first = must && i == 0;
    if (bytes_ + sum + more > memory_bytes_) make_room(sum + more, is_first ? Evict::any : Evict::unused);
    if (bytes_ + sum + more > memory_bytes_) return i;
    sum += more;
  }
  return all.size();
}

void TreeStore::finish(std::vector<Building>& all) {
  std::uint64_t building = 0;
  for (const Building& b : all) building += b.bytes;
  counts_.peak_bytes = std::max(counts_.peak_bytes, bytes_ + building);
  pool_.parallel_for(all.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      Building& b = all[i];
      try {
        if (b.source) b.tree = std::make_unique<const QueryTree>(*b.source);
      } catch (const InputError& error) {
        b.problem = error.what();
      }
      b.source.reset();
    }
  });
  for (Building& b : all) {
    Entry& entry = entries_[b.key];
    entry.used = pass_;
    entry.bytes = b.tree ? b.tree->bytes() : 0;
    bytes_ += entry.bytes;
    counts_.trees_built += b.tree ? 1 : 0;
    entry.tree = std::move(b.tree);
    if (!b.problem.empty()) tell(b.problem);
  }
}

void TreeStore::build(const std::vector<QueryTreeKey>& by_request_count) {
  bool any = false;
  for (std::size_t at = 0; at < by_request_count.size();) {
    std::vector<Building> all(std::min(std::size_t(pool_.threads()), by_request_count.size() - at));
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i].key = by_request_count[at + i];
      all[i].shard = numbers_.shard(all[i].key.shard);
    }
    open(all);
    const std::size_t admitted = admit(all, !any);
    const bool full = admitted < all.size();
    all.resize(admitted);
    finish(all);
    if (full) return;
    at += admitted;
    any = true;
  }
}

}  // namespace gigabake
