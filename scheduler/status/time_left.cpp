#include "scheduler/status/time_left.h"

#include <algorithm>

namespace gigabake {
namespace {

constexpr std::size_t min_parts = 4;
constexpr double min_fraction = 0.25;
/// First parts have no weight once the later parts together took this many times as long as the first parts.
constexpr double first_parts_horizon = 2;

}  // namespace

void TimeLeft::begins(std::size_t worker, double now_s) {
  if (workers_.size() <= worker) workers_.resize(worker + 1);
  if (workers_[worker].since_s) return;
  workers_[worker] = {now_s, true};
}

void TimeLeft::ends(std::size_t worker, double cost, double now_s) {
  begins(worker, now_s);
  Worker& w = workers_[worker];
  Ended& sum = w.is_first ? first_ : later_;
  sum.cost += cost;
  sum.seconds += std::max(0.0, now_s - *w.since_s);
  w = {now_s, false};
  ++parts_;
}

void TimeLeft::rests(std::size_t worker) {
  if (worker < workers_.size()) workers_[worker].since_s.reset();
}

/// Returns the cost per second of one worker.
double TimeLeft::rate() const {
  const double share = std::max(0.0, 1 - later_.seconds / (first_parts_horizon * std::max(first_.seconds, 1e-9)));
  return (later_.cost + share * first_.cost) / std::max(later_.seconds + share * first_.seconds, 1e-9);
}

std::optional<double> TimeLeft::left_s(double cost_left, double now_s) const {
  const auto busy = std::size_t(std::ranges::count_if(workers_, [](const Worker& w) { return w.since_s.has_value(); }));
  const double ended = first_.cost + later_.cost, speed = rate();
  if (!(speed > 0) || (parts_ < min_parts * busy && ended < min_fraction * (ended + cost_left))) return std::nullopt;
  const double part = ended / double(parts_);
  double in_hand = 0;
  for (const Worker& w : workers_)
    if (w.since_s) in_hand += std::min(part, speed * std::max(0.0, now_s - *w.since_s));
  return std::max(0.0, cost_left - in_hand) / (speed * double(std::max<std::size_t>(1, busy)));
}

}  // namespace gigabake
