/// A count of objects that share a limited resource. A thread can wait until enough of the resource is free.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>

namespace gigabake {

/// Thread-safe.
class LiveCount {
 public:
  /// Counts an object until the result is destroyed. This LiveCount must outlive the result.
  std::shared_ptr<const void> add() {
    {
      const std::scoped_lock lock(mutex_);
      ++live_;
    }
    return {this, [this](const void*) {
              const std::scoped_lock lock(mutex_);
              --live_;
              has_ended_.notify_all();
            }};
  }

  bool is_zero() const {
    const std::scoped_lock lock(mutex_);
    return live_ == 0;
  }

  /// Waits until `is_enough()` returns true, or no object is counted. Calls it again whenever an object ends.
  template <class IsEnough>
  void wait_until(const IsEnough& is_enough) {
    std::unique_lock lock(mutex_);
    has_ended_.wait(lock, [&] { return live_ == 0 || is_enough(); });
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable has_ended_;
  std::size_t live_ = 0;
};

}  // namespace gigabake
