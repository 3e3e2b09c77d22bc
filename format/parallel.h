/// A loop over ranges on a few short-lived threads, for the file side's bulk work (hash, verify).
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace gigabake {

/// body(begin, end) over [0, count) in ranges of `grain`, in no particular order, on at most `threads` threads.
/// The first exception thrown by a body is rethrown.
template <class Body>
void parallel_ranges(std::size_t count, std::size_t grain, int threads, const Body& body) {
  const std::size_t ranges = (count + grain - 1) / grain;
  std::atomic<std::size_t> next{0};
  std::exception_ptr error;
  std::mutex mutex;
  const auto work = [&] {
    try {
      for (std::size_t r = next++; r < ranges; r = next++) body(r * grain, std::min(count, (r + 1) * grain));
    } catch (...) {
      next = ranges;
      const std::scoped_lock lock(mutex);
      if (!error) error = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> helpers;
    for (std::size_t t = 1; t < std::min<std::size_t>(std::size_t(std::max(1, threads)), ranges); ++t)
      helpers.emplace_back(work);
    work();
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace gigabake
