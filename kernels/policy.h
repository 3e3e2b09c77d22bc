/// The threaded CPU execution policy: the only place in kernels/ that owns threads.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace gigabake::kernels {

/// Runs loops on a fixed set of threads and the caller's, several callers' at once. Move-only; not re-entrant from
/// inside its own loops.
class CpuPolicy {
 public:
  explicit CpuPolicy(int threads);
  ~CpuPolicy();
  CpuPolicy(CpuPolicy&&) noexcept;
  CpuPolicy& operator=(CpuPolicy&&) noexcept;

  int threads() const;

  /// body(begin, end, thread) over [0, count) in ranges of at most `grain`, in no particular order; thread is in
  /// [0, threads()). Returns when all ranges ran. The first exception thrown by a body is rethrown here.
  void parallel_for(std::size_t count, std::size_t grain,
                    const std::function<void(std::size_t begin, std::size_t end, int thread)>& body) const;

 private:
  struct Pool;
  std::unique_ptr<Pool> pool_;
};

}  // namespace gigabake::kernels
