/// The one loop facility: every loop that runs on several of the host's threads runs through here. It was compared with
/// oneTBB (decision 205).
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace gigabake {

/// Runs loops on the threads of the pool and on the caller's own thread; several callers' loops may run at the same
/// time. Move-only. The body of a loop must not start another loop on the same pool.
class ThreadPool {
 public:
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(ThreadPool&&) noexcept;
  ThreadPool& operator=(ThreadPool&&) noexcept;

  int threads() const;

  /// body(begin, end, thread) over [0, count) in ranges of at most `grain`, in no particular order; thread is in
  /// [0, threads()). Returns when all ranges ran. The first exception thrown by a body is rethrown here.
  void parallel_for(std::size_t count, std::size_t grain,
                    const std::function<void(std::size_t begin, std::size_t end, int thread)>& body) const;

 private:
  struct Pool;
  std::unique_ptr<Pool> pool_;
};

/// A pool without threads of its own: its loops run on the caller's thread alone.
const ThreadPool& callers_thread();

}  // namespace gigabake
