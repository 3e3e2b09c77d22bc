/// A wish from outside to end: Ctrl-C (SIGINT) or SIGTERM.
#pragma once

#include <string>

namespace gigabake::app {

/// What a second signal prints where a command writes files.
inline constexpr const char* stopped_while_writing =
    "gigabake: stopped at once; files that were whole are as they were, a .part file may be left beside them\n";

/// While it is there, the first of these signals is noted; the second one prints `last_words` and ends the process. The
/// flag is the process's: one of them at a time. last_words: a literal. Errors  std::runtime_error.
class StopSignals {
 public:
  explicit StopSignals(const char* last_words = stopped_while_writing);
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
};

/// The signal that has come, now or while an earlier one was there; 0: none.
int stop_signal();

/// What a command that was stopped says last.
std::string stop_line();

/// As shells have it: 128 and the signal; where another rank was signalled, as for SIGTERM.
int exit_code_of_stop();

/// Says so and ends the process, without destructors.
[[noreturn]] void end_as_stopped();

}  // namespace gigabake::app
