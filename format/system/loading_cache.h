/// Cache of values that are expensive to make, shared by threads: one thread makes a value, others wait for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/base/lru_cache.h"

namespace gigabake {

/// Cost of a value in a cache that is bounded in bytes.
struct CostInBytes {
  template <class Value>
  std::uint64_t operator()(const Value& value) const {
    return value.bytes();
  }
};
/// Cost of a value in a cache that is bounded in entries.
struct CostOfEntry {
  template <class Value>
  std::uint64_t operator()(const Value&) const {
    return 1;
  }
};

/// A cache that evicts the least recently used values. An evicted value stays alive while a caller holds it.
/// Thread-safe.
template <class Key, class Value, class KeyHash = std::hash<Key>, class Cost = CostInBytes>
class LoadingCache {
 public:
  /// `capacity` and `min_entries` have the same meaning as in LruCache.
  explicit LoadingCache(std::uint64_t capacity, std::size_t min_entries = 0) : values_(capacity, min_entries) {}

  /// Returns the value of `key`; if absent, calls `load()`, which returns a non-null std::shared_ptr<const Value>. One
  /// caller loads; concurrent callers with the same key wait for its result.
  /// Errors  An exception of load() is thrown to all waiting callers; no value is cached, and the next caller loads
  ///         again.
  template <class Load>
  std::shared_ptr<const Value> get(const Key& key, const Load& load) {
    std::promise<Pointer> promise;
    Future pending;
    if (Pointer value = find_or_announce(key, promise, pending)) return value;
    return pending.valid() ? pending.get() : load_announced(key, promise, load);
  }

  /// Loads the value of `key` for later calls of get(). Does nothing if the value is cached or another caller loads it.
  /// Errors  None. If load() throws, no value is cached, and get() loads again and throws.
  template <class Load>
  void load_ahead(const Key& key, const Load& load) {
    std::promise<Pointer> promise;
    Future pending;
    if (find_or_announce(key, promise, pending) || pending.valid()) return;
    try {
      load_announced(key, promise, load);
    } catch (...) {  // of no value that is needed yet
    }
  }

  /// Removes a loaded value, so that the next get() loads it again. Callers that hold the value keep it.
  void drop(const Key& key) {
    std::optional<Pointer> removed;  // destroyed after the lock is released
    const std::scoped_lock lock(mutex_);
    removed = values_.erase(key);
  }

  /// Returns the cost of the cached values; at most the capacity, or the cost of `min_entries` values.
  std::uint64_t cost() const {
    const std::scoped_lock lock(mutex_);
    return values_.cost();
  }

 private:
  using Pointer = std::shared_ptr<const Value>;
  using Future = std::shared_future<Pointer>;

  /// Returns the cached value. Otherwise sets `pending` to the result of the caller that is loading it, or announces
  /// `promise` as the result if no caller is loading it.
  Pointer find_or_announce(const Key& key, std::promise<Pointer>& promise, Future& pending) {
    const std::scoped_lock lock(mutex_);
    if (const Pointer* value = values_.find(key)) return *value;
    const auto [at, is_new] = loading_.try_emplace(key);
    if (is_new)
      at->second = promise.get_future().share();
    else
      pending = at->second;
    return nullptr;
  }

  template <class Load>
  Pointer load_announced(const Key& key, std::promise<Pointer>& promise, const Load& load) {
    try {
      Pointer value = load();
      keep(key, value);
      promise.set_value(value);
      return value;
    } catch (...) {
      forget(key);
      promise.set_exception(std::current_exception());
      throw;
    }
  }

  void keep(const Key& key, const Pointer& value) {
    const std::uint64_t cost = Cost()(*value);
    std::vector<Pointer> removed;  // destroyed after the lock is released
    const std::scoped_lock lock(mutex_);
    removed = values_.insert(key, value, cost);
    loading_.erase(key);
  }

  void forget(const Key& key) {
    const std::scoped_lock lock(mutex_);
    loading_.erase(key);
  }

  mutable std::mutex mutex_;
  LruCache<Key, Pointer, KeyHash> values_;
  std::unordered_map<Key, Future, KeyHash> loading_;
};

}  // namespace gigabake
