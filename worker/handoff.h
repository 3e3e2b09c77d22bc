/// Where one stage of the pipeline hands values to the next: hand to hand, or with room for a few in between. Memory
/// holds no more cells than there are stages and places.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace gigabake {

/// Any number of givers and takers. Thread-safe.
template <class T>
class Handoff {
 public:
  /// room: how many values may wait for their taker without their giver. 0: hand to hand.
  explicit Handoff(std::size_t room = 0) : room_(room) {}

  /// Returns when the value is taken, or one of as many as there is room for.
  void give(T value) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return values_.size() <= room_; });  // of several givers one stands at the counter
    values_.push_back(std::move(value));
    changed_.notify_all();
    const std::uint64_t mine = ++given_;
    changed_.wait(lock, [this, mine] { return taken_ + room_ >= mine; });
  }

  /// No value follows. To be called by the last giver, once the others have returned.
  void close() {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

  /// Waits for a value; none when closed.
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
  const std::size_t room_;
  std::deque<T> values_;
  std::uint64_t given_ = 0, taken_ = 0;
  bool closed_ = false;
};

}  // namespace gigabake
