/// The only loop facility: all multi-threaded loops of the host use it. Decision 205 compares it with oneTBB.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace gigabake {

/// A pool that runs loops on its threads and on the caller's thread. Several callers may run loops concurrently.
/// Move-only. A loop's body must not start another loop on the same pool.
class ThreadPool {
 public:
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(ThreadPool&&) noexcept;
  ThreadPool& operator=(ThreadPool&&) noexcept;

  int threads() const;

  /// Calls body(begin, end, thread) over [0, count) in ranges of at most `grain`, in no particular order; thread is in
  /// [0, threads()). Returns when all ranges have run. If a body throws, rethrows the first exception and skips the
  /// remaining ranges.
  void parallel_for(std::size_t count, std::size_t grain,
                    const std::function<void(std::size_t begin, std::size_t end, int thread)>& body) const;

  class Running;
  /// Starts the loop of parallel_for() on the other threads of the pool, while the caller does other work.
  [[nodiscard]] Running start(std::size_t count, std::size_t grain,
                              std::function<void(std::size_t begin, std::size_t end, int thread)> body) const;

 private:
  struct Pool;
  struct Loop;
  std::unique_ptr<Pool> pool_;
};

/// A loop that threads of a pool run. The pool must outlive it.
class ThreadPool::Running {
 public:
  /// Skips the ranges that have not begun, and waits for the others.
  ~Running();
  Running(Running&&) noexcept;
  Running& operator=(Running&&) = delete;

  /// Runs ranges on the caller's thread, too. Returns when all ranges have run, or throws like parallel_for().
  void finish();

 private:
  friend class ThreadPool;
  Running(Pool& pool, std::unique_ptr<Loop> loop);

  Pool* pool_;
  std::unique_ptr<Loop> loop_;  ///< null: finished
};

/// Returns a pool without threads: its loops run on the caller's thread.
const ThreadPool& callers_thread();

}  // namespace gigabake
