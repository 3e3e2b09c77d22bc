/// Progress display of a bake: a bar on a terminal, periodic lines in a log.
#pragma once

#include <chrono>
#include <cstdio>
#include <optional>
#include <string>

#include "scheduler/status/bake_status.h"

namespace gigabake::app {

class ProgressLine {
 public:
  /// `line_every_s` is the time between lines in a log. On a terminal, the bar is redrawn at most ten times per second.
  ProgressLine(std::FILE* stream, double line_every_s);
  /// Ends the bar's line.
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Prints the status if the interval has passed, and once when the scan or the last cell is complete.
  void show(const BakeStatus& status);
  /// Prints `line` on a separate line in place of the bar.
  void say(const std::string& line);
  /// Ends the bar's line, so that further output starts on a new line.
  void leave_bar();

 private:
  void write_line(const std::string& line);

  using Clock = std::chrono::steady_clock;
  enum class Phase { scan, cells };

  std::FILE* stream_;
  bool terminal_, bar_is_shown_ = false;
  Clock::duration every_;
  Clock::time_point last_;
  std::optional<Phase> ended_;  ///< the phase whose completion has been shown
};

}  // namespace gigabake::app
