/// External requests to end early but orderly. Batch systems send SIGUSR1 before the time limit; a batch system or a
/// user ends the job by SIGTERM; Ctrl-C sends SIGINT.
#pragma once

#include <string_view>

namespace gigabake {

/// Installs handlers that record these signals instead of ending the process. A second SIGINT prints the text of
/// set_last_words() and ends the process.
/// Errors  std::runtime_error.
void watch_for_drain();

/// Sets the text that a second SIGINT prints: the state in which it leaves the bake. Truncated to 300 bytes. Not
/// thread-safe.
void set_last_words(std::string_view line);

/// Returns true once one of these signals has arrived.
bool is_drain_asked();

/// Ends this process when its parent mpirun dies, so that a killed mpirun leaves no rank that continues to write. Does
/// nothing without mpirun.
/// Errors  std::runtime_error.
void end_with_mpirun();

}  // namespace gigabake
