/// Stop requests by signal: Ctrl-C (SIGINT) or SIGTERM.
#pragma once

#include <string>

namespace gigabake::app {

/// The message that a second signal prints if a command writes files.
inline constexpr const char* stopped_while_writing =
    "gigabake: stopped immediately; complete files are unchanged, but a .part file may be left next to them\n";

/// A scope that records the first SIGINT or SIGTERM. The second signal prints `last_words`, a string literal, and ends
/// the process. The state belongs to the process: use only one object at a time.
/// Errors  std::runtime_error: sigaction() failed.
class StopSignals {
 public:
  explicit StopSignals(const char* last_words = stopped_while_writing);
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
};

/// Returns the first stop signal received in this or an earlier scope; 0 if none.
int stop_signal();

/// Returns the last message of a stopped command.
std::string stop_line();

/// Returns 128 + the signal, like shells; if only another rank received a signal, 128 + SIGTERM.
int exit_code_of_stop();

/// Prints stop_line() and ends the process without running destructors.
[[noreturn]] void exit_as_stopped();

}  // namespace gigabake::app
