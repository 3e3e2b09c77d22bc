/// Who started this process, as its environment says it. srun without Open MPI's own interface starts tasks that know
/// nothing of each other: each would bake everything.
#pragma once

#include <optional>
#include <string>

#include "format/system/host_limits.h"

namespace gigabake {

/// Tasks that Slurm started beside this process, itself included; 1 where mpirun did, in a batch script, which is no
/// task, and without Slurm. To be asked before MPI_Init, which sets some of the variables itself.
int tasks_of_srun(const Environment& environment);

/// Whether mpirun, srun or another launcher started this process, and there may be other ranks. To be asked before
/// MPI_Init, which sets some of the variables itself.
bool is_launched(const Environment& environment);

/// The line that a rank of a world of `ranks` ends with, where Slurm started `tasks`; none where all is well.
std::optional<std::string> lone_task(int ranks, int tasks);

}  // namespace gigabake
