#include "format/system/meters/stage_clock.h"

#include <algorithm>
#include <numeric>

namespace gigabake {
namespace {

/// Adds the seconds of an interval in which `threads` threads were in each stage.
void add_interval(double seconds, const std::array<int, StageTimes::stages>& threads, StageTimes& times) {
  const auto busy = std::count_if(threads.begin(), threads.end(), [](int n) { return n > 0; });
  if (busy == 0)
    times.idle_s += seconds;
  else if (busy > 1)
    times.several_s += seconds;
  else
    times.exclusive_s[std::size_t(std::find_if(threads.begin(), threads.end(), [](int n) { return n > 0; }) -
                                  threads.begin())] += seconds;
}

}  // namespace

double StageTimes::all_s() const { return std::accumulate(exclusive_s.begin(), exclusive_s.end(), several_s + idle_s); }

StageTimes& StageTimes::operator+=(const StageTimes& other) {
  for (std::size_t s = 0; s < stages; ++s) exclusive_s[s] += other.exclusive_s[s];
  several_s += other.several_s;
  idle_s += other.idle_s;
  return *this;
}

StageTimes StageTimes::since(const StageTimes& earlier) const {
  StageTimes difference = *this;
  for (std::size_t s = 0; s < stages; ++s) difference.exclusive_s[s] -= earlier.exclusive_s[s];
  difference.several_s -= earlier.several_s;
  difference.idle_s -= earlier.idle_s;
  return difference;
}

std::optional<BakeStage> StageTimes::bound() const {
  const auto bound = std::max_element(exclusive_s.begin(), exclusive_s.end());
  if (*bound <= 0) return std::nullopt;
  return BakeStage(bound - exclusive_s.begin());
}

void StageClock::advance(Clock::time_point now) {
  if (latest_ && now > *latest_) add_interval(std::chrono::duration<double>(now - *latest_).count(), threads_, times_);
  latest_ = std::max(latest_.value_or(now), now);
}

void StageClock::enter(BakeStage stage, Clock::time_point now) {
  const std::scoped_lock lock(mutex_);
  advance(now);
  ++threads_[std::size_t(stage)];
}

void StageClock::leave(BakeStage stage, Clock::time_point now) {
  const std::scoped_lock lock(mutex_);
  advance(now);
  --threads_[std::size_t(stage)];
}

StageTimes StageClock::times(Clock::time_point now) const {
  const std::scoped_lock lock(mutex_);
  StageTimes times = times_;
  if (latest_ && now > *latest_) add_interval(std::chrono::duration<double>(now - *latest_).count(), threads_, times);
  return times;
}

StageClock& process_stage_clock() {
  static StageClock clock;
  return clock;
}

}  // namespace gigabake
