/// A request from outside to end soon and in order: SIGUSR1 (what batch systems send before the time is up), SIGTERM
/// (a batch system or a person ends the job) or SIGINT (Ctrl-C).
#pragma once

namespace gigabake {

/// From now on these signals are noted instead of ending the process. A second SIGINT ends it as usual.
/// Errors  std::runtime_error.
void watch_for_drain();

/// One of them came.
bool is_drain_asked();

/// Ends this process when the one that started it is gone: an mpirun that is killed leaves no rank behind that goes on
/// writing. Does nothing where there is no mpirun. Errors  std::runtime_error.
void end_with_mpirun();

}  // namespace gigabake
