/// Start of several ranks by a command that was started without mpirun.
#pragma once

#include <optional>

#include "app/options/bake_options.h"

namespace gigabake::app {

/// Returns the number of ranks that this process shall start; nullopt if it bakes by itself. The default is one rank
/// per GPU of the host, and no start in a batch job. Prints one line if mpirun is missing although there are several
/// GPUs. Call it before MPI starts.
/// Errors  UsageError: --ranks is out of range, or this process cannot start ranks.
std::optional<int> ranks_to_start(const BakeOptions& options);

/// Runs this process's command line, without --ranks, on `ranks` ranks of this host. Returns the exit code.
/// Errors  std::system_error: mpirun cannot be started.
int run_on_ranks(const BakeOptions& options, int ranks);

}  // namespace gigabake::app
