/// A bake's status as it changes: a bar on a terminal, now and then a line in a log.
#pragma once

#include <chrono>
#include <cstdio>
#include <optional>
#include <string>

#include "scheduler/bake_status.h"

namespace gigabake::app {

class ProgressLine {
 public:
  /// line_every_s: in a log. A bar is drawn ten times a second at most.
  ProgressLine(std::FILE* stream, double line_every_s);
  /// Leaves the bar's line.
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Where it is time to, and always once when survey or cells are all done.
  void show(const BakeStatus& status);
  /// A line of its own, where the bar was.
  void say(const std::string& line);
  /// What comes next starts on a line of its own.
  void leave_bar();

 private:
  void write_line(const std::string& line);

  using Clock = std::chrono::steady_clock;
  enum class Phase { survey, cells };

  std::FILE* stream_;
  bool terminal_, bar_is_there_ = false;
  Clock::duration every_;
  Clock::time_point last_;
  std::optional<Phase> ended_;  ///< has been shown as all done
};

}  // namespace gigabake::app
