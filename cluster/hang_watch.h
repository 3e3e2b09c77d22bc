/// Tells a process that hangs from one that works long: a value that a test can replay with times of its own.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "cluster/child_process.h"

namespace gigabake {

/// Counts *watched* time: of the time between two looks at most a quarter of `stall`, so that a machine that slept, or
/// an owner that was stopped with its whole job, takes nobody for dead.
class HangWatch {
 public:
  using Clock = std::chrono::steady_clock;

  explicit HangWatch(Clock::duration stall);

  /// From now on there is something to do.
  void start(Clock::time_point now);
  /// Looking more often than this tells nothing new.
  Clock::time_point next_look() const { return last_look_ + interval_; }
  /// activity: none where nobody can tell; then only time limits help. message_bytes: that went either way so far.
  void look(Clock::time_point now, const std::optional<ProcessActivity>& activity, std::uint64_t message_bytes);

  /// No progress of any kind for `stall`.
  bool is_stalled() const { return watched_ - progress_ >= stall_; }
  /// Since the watch was made.
  Clock::duration watched() const { return watched_; }

 private:
  Clock::duration stall_, interval_;
  Clock::time_point last_look_{};
  Clock::duration watched_{}, progress_{};
  ProcessActivity last_activity_;
  std::uint64_t last_message_bytes_ = 0;
};

}  // namespace gigabake
