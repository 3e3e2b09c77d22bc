/// A map whose values have costs, such as bytes. Above a capacity, it evicts the least recently used values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <list>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gigabake {

/// A map from keys to values, with a capacity. The class is not thread-safe: the caller guards it by a mutex, or uses
/// LoadingCache (format/system/loading_cache.h).
template <class Key, class Value, class KeyHash = std::hash<Key>>
class LruCache {
 public:
  /// `capacity` is the max sum of the costs. The `min_entries` most recently used values stay even above the capacity.
  explicit LruCache(std::uint64_t capacity, std::size_t min_entries = 0)
      : capacity_(capacity), min_entries_(min_entries) {}

  /// Returns the value of `key` and makes it the most recently used one; returns null if there is none. The pointer is
  /// valid until the next insert() or erase().
  Value* find(const Key& key) { return found(key, entries_.begin()); }
  /// Returns the value like find(), but makes it the next one to be evicted. Use it for the last access to a value.
  Value* find_for_last_use(const Key& key) { return found(key, entries_.end()); }

  /// Inserts or replaces a value as the most recently used one. Returns the replaced and the evicted values. If the
  /// cost of `value` exceeds the capacity and min_entries is 0, returns `value` too. The caller can destroy the
  /// returned values after it has released its lock.
  [[nodiscard]] std::vector<Value> insert(const Key& key, Value value, std::uint64_t cost) {
    std::vector<Value> removed;
    if (auto replaced = erase(key)) removed.push_back(std::move(*replaced));
    if (cost > capacity_ && min_entries_ == 0) {
      removed.push_back(std::move(value));
      return removed;
    }
    entries_.push_front({key, std::move(value), cost});
    by_key_[key] = entries_.begin();
    cost_ += cost;
    while (cost_ > capacity_ && entries_.size() > min_entries_) removed.push_back(take(std::prev(entries_.end())));
    return removed;
  }

  /// Removes a value and returns it; nullopt if there is none.
  std::optional<Value> erase(const Key& key) {
    const auto at = by_key_.find(key);
    if (at == by_key_.end()) return std::nullopt;
    return take(at->second);
  }

  /// Returns the sum of the costs.
  std::uint64_t cost() const { return cost_; }

 private:
  struct Entry {
    Key key;
    Value value;
    std::uint64_t cost;
  };
  using Entries = std::list<Entry>;

  Value* found(const Key& key, typename Entries::iterator move_before) {
    const auto at = by_key_.find(key);
    if (at == by_key_.end()) return nullptr;
    entries_.splice(move_before, entries_, at->second);
    return &at->second->value;
  }

  Value take(typename Entries::iterator entry) {
    Value value = std::move(entry->value);
    cost_ -= entry->cost;
    by_key_.erase(entry->key);
    entries_.erase(entry);
    return value;
  }

  const std::uint64_t capacity_;
  const std::size_t min_entries_;
  Entries entries_;  ///< the last entry is the next one to be evicted
  std::unordered_map<Key, typename Entries::iterator, KeyHash> by_key_;
  std::uint64_t cost_ = 0;
};

}  // namespace gigabake
