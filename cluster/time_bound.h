/// Ends the process where a call into MPI does not come back: MPI_Init, MPI_Finalize and MPI_Abort wait for ever for a
/// rank that died or was stopped at the wrong moment, and nothing can make them return.
#pragma once

namespace gigabake {

/// The longest that a rank waits in one of these calls: GIGABAKE_MPI_SECONDS of the environment (1 to 86400), else 120.
double longest_mpi_call_s();

/// From its making to its end: a call that takes longer ends the process by SIGALRM, so that mpirun sees a rank die and
/// ends the launch. Before that the process says so in one line on standard error; of many ranks the first two do.
/// One at a time in a process. Errors  std::runtime_error: the system sets no timer.
class TimeBound {
 public:
  TimeBound(double longest_s, const char* call);
  ~TimeBound();
  TimeBound(const TimeBound&) = delete;
  TimeBound& operator=(const TimeBound&) = delete;
};

}  // namespace gigabake
