/// Cache of the data that overviews need from recently written shards, so that they need not read the files.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "core/base/lru_cache.h"
#include "worker/overview/overview_bake.h"

namespace gigabake {

/// Caches children up to a number of bytes. Evicts children that an overview has used first, then the oldest.
/// Thread-safe.
class OverviewInputs {
 public:
  explicit OverviewInputs(std::uint64_t budget_bytes) : children_(budget_bytes) {}

  /// Replaces the entry of this file name. A child larger than the budget is not kept.
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
