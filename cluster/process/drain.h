/// External requests to end early but orderly. Batch systems send SIGUSR1 before the time limit; a batch system or a
/// user ends the job by SIGTERM; Ctrl-C sends SIGINT.
#pragma once

#include <string_view>

namespace gigabake {

/// Installs handlers that record SIGUSR1, SIGTERM and SIGINT instead of ending the process. A second SIGINT prints the
/// text of set_interrupt_message() and ends the process.
/// Errors  std::runtime_error.
void install_drain_handlers();

/// Sets the text that a second SIGINT prints. The text states what the end of the process leaves in OUT. It is
/// truncated to 300 bytes. Not thread-safe.
void set_interrupt_message(std::string_view line);

/// Returns true once SIGUSR1, SIGTERM or SIGINT has arrived.
bool is_drain_requested();

/// Ends this process when its parent mpirun dies, so that a killed mpirun leaves no rank that continues to write. Does
/// nothing without mpirun.
/// Errors  std::runtime_error.
void end_if_mpirun_dies();

}  // namespace gigabake
