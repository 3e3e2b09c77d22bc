/// Estimate of the remaining time from the speed of workers so far.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace gigabake {

/// An estimator of the remaining time. A part is a job, or any other piece of work that a worker finishes as a whole.
/// The speed of a worker is the cost of its finished parts divided by the time between their ends. If a worker has
/// several parts in flight, its first part takes longer than the following parts. The weight of first parts therefore
/// falls as more parts finish. Parts in flight count as partly done at the estimated speed. The remaining time
/// therefore falls between the ends of two parts, and stays constant if a part ends late.
/// Exact   Deterministic: the same calls give the same answers. Costs have any unit, times are seconds of any clock.
class TimeLeft {
 public:
  /// Records that the worker has work from now on; has no effect if it already has work.
  void begins(std::size_t worker, double now_s);
  /// Records that the worker has finished a part.
  void ends(std::size_t worker, double cost, double now_s);
  /// Records that the worker has no work or lost its parts in flight. The time since the end of its last part is not
  /// counted.
  void rests(std::size_t worker);

  /// Returns the remaining seconds. `cost_left` is the cost of all unfinished parts, in flight or not. Returns nullopt
  /// if too few parts have finished: fewer than four per busy worker and less than a quarter of the cost.
  std::optional<double> left_s(double cost_left, double now_s) const;

 private:
  struct Worker {
    std::optional<double> since_s;  ///< time of the last ends(), or of begins(); nullopt: idle
    bool is_first = true;           ///< no part has finished since begins()
  };
  /// Sums over finished parts.
  struct Ended {
    double cost = 0, seconds = 0;
  };
  double rate() const;

  std::vector<Worker> workers_;
  Ended first_, later_;
  std::size_t parts_ = 0;
};

}  // namespace gigabake
