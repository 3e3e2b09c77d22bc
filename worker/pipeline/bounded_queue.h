/// Bounded queue between two stages of the pipeline; capacity 0 is a rendezvous. It bounds the number of cells in
/// memory by the number of stages and the capacities.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace gigabake {

/// A queue for any number of producers and consumers. Thread-safe.
template <class T>
class BoundedQueue {
 public:
  /// `capacity` is the number of values that may stay queued after their push() has returned. 0 makes every push() wait
  /// for a take().
  explicit BoundedQueue(std::size_t capacity = 0) : capacity_(capacity) {}

  /// Queues the value. Returns once the value is taken, or is among the first `capacity` values in the queue.
  void push(T value) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return values_.size() <= capacity_; });  // at most capacity + 1 values
    values_.push_back(std::move(value));
    changed_.notify_all();
    const std::uint64_t mine = ++given_;
    changed_.wait(lock, [this, mine] { return taken_ + capacity_ >= mine; });
  }

  /// Marks the end of the values. Must be called after the last push() has returned.
  void close() {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

  /// Waits for a value; returns nullopt once the queue is closed and empty.
  std::optional<T> take() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !values_.empty() || closed_; });
    if (values_.empty()) return std::nullopt;
    std::optional<T> taken = std::move(values_.front());
    values_.pop_front();
    ++taken_;
    changed_.notify_all();
    return taken;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  const std::size_t capacity_;
  std::deque<T> values_;
  std::uint64_t given_ = 0, taken_ = 0;
  bool closed_ = false;
};

}  // namespace gigabake
