/// Detection of the launcher from the environment. srun without Open MPI's interface starts tasks that do not know of
/// each other; each would bake everything.
#pragma once

#include <optional>
#include <string>

#include "format/system/host_limits.h"

namespace gigabake {

/// The value of HWLOC_COMPONENTS for Open MPI, whose hwloc otherwise probes GPUs. It searches X displays, and ends the
/// process when such a display closes. It also starts OpenCL, and thereby the driver of each GPU.
inline constexpr const char* hwloc_without_gpus = "-gl,-opencl";

/// Returns the number of tasks of this Slurm step, this process included. Returns 1 under mpirun, without Slurm, and in
/// a batch script, which is no task. Call it before MPI_Init, which sets some of the environment variables itself.
int slurm_task_count(const Environment& environment);

/// Returns true if mpirun, srun or another launcher started this process, so that other ranks may exist. Call it before
/// MPI_Init, which sets some of the environment variables itself.
bool is_launched(const Environment& environment);

/// Returns this process's rank as the launcher states it before MPI_Init; 0 if no launcher does.
int rank_from_launcher(const Environment& environment);

/// The index of a process among those that its launcher started on this host.
struct LocalRank {
  int rank = 0, ranks = 1;
};
/// Returns the local rank as the launcher states it before MPI_Init, or the only one if no launcher started this
/// process. Returns nullopt if the launcher does not state it.
std::optional<LocalRank> local_rank_from_launcher(const Environment& environment);

/// Returns the error line of a build without MPI if a launcher may have started more than this process; else nullopt.
std::optional<std::string> ranks_without_mpi_error(const Environment& environment);

/// Returns the error line if Slurm started `tasks` tasks but the MPI world has only one rank; else nullopt.
std::optional<std::string> unlaunched_rank_error(int ranks, int tasks);

}  // namespace gigabake
