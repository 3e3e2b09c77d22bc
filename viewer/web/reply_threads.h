/// Threads for replies that take a while: a bounded number, and all of them end before their owner does.
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
  explicit ReplyThreads(std::size_t most) : most_(most) {}
  ~ReplyThreads() { finish(); }
  ReplyThreads(const ReplyThreads&) = delete;
  ReplyThreads& operator=(const ReplyThreads&) = delete;

  /// Runs work, which must not throw, on a thread of its own. False: as many run already, the system has no more, or
  /// finish() was called.
  bool start(std::function<void()> work);
  /// Returns when all have ended; none starts from now on.
  void finish();

 private:
  struct Running {
    std::atomic<bool> done = false;
    std::thread thread;
  };

  const std::size_t most_;
  std::mutex mutex_;
  bool finished_ = false;
  std::list<Running> running_;
};

}  // namespace gigabake
