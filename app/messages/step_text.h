/// What is said of a command's steps, and when: nothing in the first two seconds, then a line that is rewritten on a
/// terminal and a line every ten seconds in a log.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "scheduler/time_left.h"

namespace gigabake::app {

/// A value: a test says what time it is. Seconds are of any clock that never goes back.
class StepText {
 public:
  StepText(double now_s, bool is_terminal);

  /// A step begins; total 0: nobody knows how much it is.
  void begin(std::string name, std::uint64_t total, std::string unit, double now_s);
  /// Nothing is said until another one begins.
  void end();
  /// The line to show now, where it is time for one. done: parts of the step. Call it some ten times a second.
  std::optional<std::string> line(std::uint64_t done, double now_s);

 private:
  std::string text(std::uint64_t done, double now_s) const;

  bool is_terminal_, is_running_ = false;
  double next_s_;  ///< when something may be said again
  std::string name_, unit_;
  std::uint64_t total_ = 0, seen_ = 0;
  double began_s_ = 0;
  TimeLeft time_left_;
};

}  // namespace gigabake::app
