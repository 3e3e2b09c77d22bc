/// A request from outside to end soon and in order: SIGUSR1 (what batch systems send before the time is up), SIGTERM
/// (a batch system or a person ends the job) or SIGINT (Ctrl-C).
#pragma once

#include <string_view>

namespace gigabake {

/// From now on these signals are noted instead of ending the process. A second SIGINT prints the last words and ends
/// it. Errors  std::runtime_error.
void watch_for_drain();

/// What a second SIGINT prints: in which state it leaves the bake. Cut after 300 bytes. Not for several threads.
void set_last_words(std::string_view line);

/// One of them came.
bool is_drain_asked();

/// Ends this process when the one that started it is gone: an mpirun that is killed leaves no rank behind that goes on
/// writing. Does nothing where there is no mpirun. Errors  std::runtime_error.
void end_with_mpirun();

}  // namespace gigabake
