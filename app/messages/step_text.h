/// Text and timing of the progress lines of a command's steps. Nothing is printed in the first two seconds. Afterwards
/// a terminal's line is rewritten, and a log gets a line every ten seconds.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "scheduler/status/time_left.h"

namespace gigabake::app {

/// The progress text of the current step. The caller passes all times, in seconds of any monotonic clock, so tests need
/// no clock.
class StepText {
 public:
  StepText(double now_s, bool is_terminal);

  /// Begins a step. `total` is the number of its parts; 0 if the number is unknown.
  void begin(std::string name, std::uint64_t total, std::string unit, double now_s);
  /// Ends the step: line() returns nullopt until the next begin().
  void end();
  /// Returns the line to show, or nullopt if the interval has not passed. `done` is the number of finished parts of the
  /// step. Call it about ten times per second.
  std::optional<std::string> line(std::uint64_t done, double now_s);

 private:
  std::string text(std::uint64_t done, double now_s) const;

  bool is_terminal_, is_running_ = false;
  double next_s_;  ///< earliest time of the next line
  std::string name_, unit_;
  std::uint64_t total_ = 0, seen_ = 0;
  double began_s_ = 0;
  TimeLeft time_left_;
};

}  // namespace gigabake::app
