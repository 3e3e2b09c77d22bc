/// Where one stage of the pipeline hands a value to the next, hand to hand: nothing waits in between, so that memory
/// holds no more cells than there are stages.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>

namespace gigabake {

/// Any number of givers and takers. Thread-safe.
template <class T>
class Handoff {
 public:
  /// Returns when the taker has the value.
  void give(T value) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !value_.has_value(); });  // another giver's
    value_ = std::move(value);
    changed_.notify_all();
    const std::uint64_t mine = ++given_;
    changed_.wait(lock, [this, mine] { return taken_ >= mine; });
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
    changed_.wait(lock, [this] { return value_.has_value() || closed_; });
    std::optional<T> taken = std::exchange(value_, std::nullopt);
    taken_ += taken.has_value();
    changed_.notify_all();
    return taken;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<T> value_;
  std::uint64_t given_ = 0, taken_ = 0;
  bool closed_ = false;
};

}  // namespace gigabake
