/// Timeout for calls of MPI that may never return: MPI_Init, MPI_Finalize and MPI_Abort can wait forever for a rank
/// that died or was stopped. These calls cannot be interrupted.
#pragma once

namespace gigabake {

/// Returns the max seconds of one of these calls: GIGABAKE_MPI_SECONDS of the environment (1 to 86400), else 120.
double max_mpi_call_s();

/// A timeout that lasts from construction to destruction. If it expires, SIGALRM ends the process, so that mpirun sees
/// a dead rank and ends the launch. Ranks 0 and 1 first print one line on standard error. A process may have only one
/// object at a time.
/// Errors  std::runtime_error: the system cannot set the timer.
class MpiCallTimeout {
 public:
  MpiCallTimeout(double limit_s, const char* call);
  ~MpiCallTimeout();
  MpiCallTimeout(const MpiCallTimeout&) = delete;
  MpiCallTimeout& operator=(const MpiCallTimeout&) = delete;
};

}  // namespace gigabake
