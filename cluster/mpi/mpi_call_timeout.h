/// Timeout for calls of MPI that may never return: MPI_Init, MPI_Finalize and MPI_Abort can wait forever for a rank
/// that died or was stopped. They cannot be interrupted.
#pragma once

namespace gigabake {

/// Returns the max duration of such a call: GIGABAKE_MPI_SECONDS of the environment (1 to 86400), else 120.
double max_mpi_call_s();

/// Timeout from construction to destruction: a longer call ends the process by SIGALRM, so that mpirun sees a dead rank
/// and ends the launch. The process prints one line on standard error first; of many ranks only the first two do.
/// One object at a time per process.
/// Errors  std::runtime_error: the system sets no timer.
class MpiCallTimeout {
 public:
  MpiCallTimeout(double limit_s, const char* call);
  ~MpiCallTimeout();
  MpiCallTimeout(const MpiCallTimeout&) = delete;
  MpiCallTimeout& operator=(const MpiCallTimeout&) = delete;
};

}  // namespace gigabake
