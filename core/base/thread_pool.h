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

 private:
  struct Pool;
  std::unique_ptr<Pool> pool_;
};

/// Returns a pool without threads: its loops run on the caller's thread.
const ThreadPool& callers_thread();

}  // namespace gigabake
