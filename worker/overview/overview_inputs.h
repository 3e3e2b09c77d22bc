/// Cache of the data that overviews need from recently written shards. It saves reading these shards again.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "core/base/lru_cache.h"
#include "worker/overview/overview_bake.h"

namespace gigabake {

/// Cache of children's data, limited to a number of bytes. Children that an overview has already used are evicted
/// first; the others are evicted in the order of insertion. Thread-safe.
class OverviewInputs {
 public:
  explicit OverviewInputs(std::uint64_t budget_bytes) : children_(budget_bytes) {}

  /// Inserts or replaces the entry of this file name. A child larger than the budget is not cached.
  void keep(const std::string& file, OverviewChild child);
  /// Returns null if there is no entry of this file name.
  std::shared_ptr<const OverviewChild> find(const std::string& file);
  /// Returns the bytes of all cached children: at most the budget.
  std::uint64_t bytes() const;

 private:
  mutable std::mutex mutex_;
  LruCache<std::string, std::shared_ptr<const OverviewChild>> children_;
};

}  // namespace gigabake
