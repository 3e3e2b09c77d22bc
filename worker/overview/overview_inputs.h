/// Cache of the data that overviews need from recently written shards, so that they need not read the files.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>

#include "worker/overview/parent_bake.h"

namespace gigabake {

/// Caches children up to a number of bytes. Evicts children that an overview has used first, then the oldest.
/// Thread-safe.
class OverviewInputs {
 public:
  explicit OverviewInputs(std::uint64_t budget_bytes) : budget_bytes_(budget_bytes) {}

  /// Replaces the entry of this file name. A child larger than the budget is not kept.
  void keep(const std::string& file, ChildOfParent child);
  /// Returns null if there is no entry of this file name.
  std::shared_ptr<const ChildOfParent> find(const std::string& file);
  /// Returns the bytes of all cached children: at most the budget.
  std::uint64_t bytes() const;

 private:
  struct Entry {
    std::string file;
    std::shared_ptr<const ChildOfParent> child;
    std::uint64_t bytes;
  };
  void erase(std::list<Entry>::iterator entry);

  const std::uint64_t budget_bytes_;
  mutable std::mutex mutex_;
  std::list<Entry> entries_;  ///< in the order of eviction
  std::unordered_map<std::string, std::list<Entry>::iterator> by_file_;
  std::uint64_t bytes_ = 0;
};

}  // namespace gigabake
