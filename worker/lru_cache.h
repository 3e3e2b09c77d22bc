/// Cache of values that are expensive to make, bounded in bytes; evicts the least recently used value.
#pragma once

#include <cstdint>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <utility>

namespace gigabake {

/// A cache that evicts the least recently used values; Value has `std::uint64_t bytes() const`. An evicted value stays
/// alive while a caller holds it. Thread-safe.
template <class Key, class Value, class KeyHash = std::hash<Key>>
class LruCache {
 public:
  explicit LruCache(std::uint64_t budget_bytes) : budget_bytes_(budget_bytes) {}

  /// Returns the value of `key`; if absent, calls `load()`, which returns a non-null std::shared_ptr<const Value>. One
  /// caller loads; concurrent callers with the same key wait for its result.
  /// Errors  An exception of load() is thrown to all waiting callers; nothing is kept, and the next caller loads again.
  template <class Load>
  std::shared_ptr<const Value> get(const Key& key, const Load& load) {
    std::promise<std::shared_ptr<const Value>> promise;
    if (auto found = find_or_announce(key, promise)) return found->get();
    try {
      std::shared_ptr<const Value> value = load();
      keep(key, value->bytes());
      promise.set_value(value);
      return value;
    } catch (...) {
      forget(key);
      promise.set_exception(std::current_exception());
      throw;
    }
  }

  /// Removes a loaded value, so that the next get() loads it again. Callers that hold the value keep it.
  void drop(const Key& key) {
    const std::scoped_lock lock(mutex_);
    const auto at = entries_.find(key);
    if (at == entries_.end() || !at->second.loaded) return;
    bytes_ -= at->second.bytes;
    uses_.erase(at->second.use);
    entries_.erase(at);
  }

  /// Returns the bytes of the cached values; at most the budget.
  std::uint64_t bytes() const {
    const std::scoped_lock lock(mutex_);
    return bytes_;
  }

 private:
  using Future = std::shared_future<std::shared_ptr<const Value>>;
  struct Entry {
    Future value;
    std::uint64_t bytes = 0;
    typename std::list<Key>::iterator use;  ///< position in uses_, once loaded
    bool loaded = false;
  };

  std::optional<Future> find_or_announce(const Key& key, std::promise<std::shared_ptr<const Value>>& promise) {
    const std::scoped_lock lock(mutex_);
    const auto [at, is_new] = entries_.try_emplace(key);
    Entry& entry = at->second;
    if (is_new) {
      entry.value = promise.get_future().share();
      return std::nullopt;
    }
    if (entry.loaded) uses_.splice(uses_.begin(), uses_, entry.use);
    return entry.value;
  }

  void keep(const Key& key, std::uint64_t value_bytes) {
    const std::scoped_lock lock(mutex_);
    Entry& entry = entries_.at(key);
    uses_.push_front(key);
    entry.use = uses_.begin();
    entry.bytes = value_bytes;
    entry.loaded = true;
    bytes_ += value_bytes;
    while (bytes_ > budget_bytes_) {
      const auto oldest = entries_.find(uses_.back());
      bytes_ -= oldest->second.bytes;
      entries_.erase(oldest);
      uses_.pop_back();
    }
  }

  void forget(const Key& key) {
    const std::scoped_lock lock(mutex_);
    const auto at = entries_.find(key);
    if (at != entries_.end() && !at->second.loaded) entries_.erase(at);
  }

  const std::uint64_t budget_bytes_;
  mutable std::mutex mutex_;
  std::unordered_map<Key, Entry, KeyHash> entries_;
  std::list<Key> uses_;  ///< of loaded entries, most recently used first
  std::uint64_t bytes_ = 0;
};

}  // namespace gigabake
