/// Ranks on this host for a command that was started without mpirun.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "format/system/host_limits.h"

namespace gigabake {

/// Returns the number of NVIDIA GPUs that a process of this host sees. This is the number of the driver's device files
/// in `devices`, at most the number of entries of CUDA_VISIBLE_DEVICES. The driver is not started, so a GPU may be
/// unusable.
int visible_gpus(const Environment& environment, const std::filesystem::path& devices = "/dev");

/// Returns true if no launcher started this process and it is not in a batch job. The script of a batch job chooses the
/// ranks. Call it before MPI_Init.
bool may_start_ranks(const Environment& environment);

/// Returns the path of mpirun in PATH; nullopt if there is none.
std::optional<std::filesystem::path> find_mpirun(const Environment& environment);

/// Runs `program` with `arguments` on `ranks` ranks of this host, and waits for their end. SIGUSR1, SIGTERM and SIGINT
/// make the ranks drain; a second SIGINT ends them immediately. The ranks end if this process dies. Standard input is
/// empty. Call it while the process has one thread.
/// Returns mpirun's exit status, or 128 plus the signal that ended mpirun.
/// Errors  std::system_error naming the call, or mpirun if it cannot be started.
int run_local_ranks(const std::filesystem::path& mpirun, int ranks, const std::filesystem::path& program,
                    const std::vector<std::string>& arguments);

}  // namespace gigabake
