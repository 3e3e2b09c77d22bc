/// The wrapper of commands that run on all ranks: MPI start and end, error message, exit code.
#pragma once

#include <functional>
#include <string>

#include "cluster/mpi/mpi_session.h"

namespace gigabake::app {

/// Runs `work` on every rank and returns rank 0's exit code on every rank. Does not start if a rank runs another
/// command or another build of the program.
int on_all_ranks(const std::string& command, const std::function<int(MpiSession&)>& work);

}  // namespace gigabake::app
