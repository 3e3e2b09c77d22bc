/// A bounded set of threads for slow replies. All threads end before their owner is destroyed.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <list>
#include <mutex>
#include <thread>

namespace gigabake {

class ReplyThreads {
 public:
  explicit ReplyThreads(std::size_t maximum) : max_count_(maximum) {}
  ~ReplyThreads() { finish(); }
  ReplyThreads(const ReplyThreads&) = delete;
  ReplyThreads& operator=(const ReplyThreads&) = delete;

  /// Runs work on a separate thread; work must not throw. Returns false if the limit is reached, the system has no more
  /// threads, or finish() was called.
  bool start(std::function<void()> work);
  /// Waits until all threads have ended, and prevents new ones.
  void finish();

 private:
  struct Running {
    std::atomic<bool> done = false;
    std::thread thread;
  };

  const std::size_t max_count_;
  std::mutex mutex_;
  bool finished_ = false;
  std::list<Running> running_;
};

}  // namespace gigabake
