/// Estimate of the remaining time from the speed of workers so far.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace gigabake {

/// Estimates the remaining time. The speed of workers is the cost of finished parts over the time between finishes. If
/// a worker has several parts in flight, its first one takes longer than the following ones. The weight of first parts
/// therefore falls as more parts finish. Parts in flight count as partly done at the estimated speed. The remaining
/// time therefore falls between two finishes, and stays constant if a finish is late.
/// Exact   A plain value: the same calls give the same answers. Costs have any unit, times are seconds of any clock.
class TimeLeft {
 public:
  /// Records that the worker has work from now on; no effect if it already had.
  void begins(std::size_t worker, double now_s);
  /// Records that the worker has finished a part.
  void ends(std::size_t worker, double cost, double now_s);
  /// Records that the worker has no work or lost its parts in flight. The time since its last finish is not counted.
  void rests(std::size_t worker);

  /// Returns the remaining seconds. cost_left: cost of all unfinished parts, in flight or not. None if too few parts
  /// have finished: fewer than four per busy worker and less than a quarter of the cost.
  std::optional<double> left_s(double cost_left, double now_s) const;

 private:
  struct Worker {
    std::optional<double> since_s;  ///< time of the last ends(), or of begins(); none: idle
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
