/// A detector that distinguishes a hung process from a busy one. It reads no clock, so a test can pass its own times.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "cluster/process/child_process.h"

namespace gigabake {

/// A counter of *watched* time: each interval between two calls of look() counts as at most a quarter of `stall`. A
/// suspended machine, or a job stopped as a whole, is therefore not taken for a hang.
class HangWatch {
 public:
  using Clock = std::chrono::steady_clock;

  explicit HangWatch(Clock::duration stall);

  /// Marks the start of work.
  void start(Clock::time_point now);
  /// Returns the earliest useful time of the next call of look().
  Clock::time_point next_look() const { return last_look_ + interval_; }
  /// Records one observation. If the system does not report `activity`, hangs are detected by time limits only.
  /// `message_bytes` is the total of bytes sent and received until now.
  void look(Clock::time_point now, const std::optional<ProcessActivity>& activity, std::uint64_t message_bytes);

  /// Returns true after `stall` of watched time without progress.
  bool is_stalled() const { return watched_ - progress_ >= stall_; }
  /// Returns the watched time since construction.
  Clock::duration watched() const { return watched_; }

 private:
  Clock::duration stall_, interval_;
  Clock::time_point last_look_{};
  Clock::duration watched_{}, progress_{};
  ProcessActivity last_activity_;
  std::uint64_t last_message_bytes_ = 0;
};

}  // namespace gigabake
