/// How long the rest of some work will take, from what its workers have done so far.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace gigabake {

/// What workers have ended with says how fast they are: its cost over the time until they ended with it. Where a worker
/// has several parts in hand at a time, its first one takes longer than those that follow, and counts the less the more
/// do. Work in hand counts as done by as much as its worker would have done of it meanwhile, so that the time left
/// falls second by second between two ends, and stays where it is when an end is late. Exact   A value: the same calls
/// give the same answers. Costs are of any unit, seconds of any clock.
class TimeLeft {
 public:
  /// The worker has something to do from now on; nothing changes where it had.
  void begins(std::size_t worker, double now_s);
  /// The worker has ended with a part of the work.
  void ends(std::size_t worker, double cost, double now_s);
  /// The worker has nothing to do any more, or lost what it had in hand: the time since its last end does not count.
  void rests(std::size_t worker);

  /// cost_left: of all that has not ended, in hand or not. None: too little has ended to tell, which is four parts of
  /// each worker that is busy, or a quarter of all.
  std::optional<double> left_s(double cost_left, double now_s) const;

 private:
  struct Worker {
    std::optional<double> since_s;  ///< when its last part ended, or when it began; none: it rests
    bool is_first = true;           ///< what it ends with next, since it began
  };
  /// Of parts that have ended.
  struct Ended {
    double cost = 0, seconds = 0;
  };
  double rate() const;

  std::vector<Worker> workers_;
  Ended first_, later_;
  std::size_t parts_ = 0;
};

}  // namespace gigabake
