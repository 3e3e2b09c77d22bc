/// The frame of a command that runs on all ranks: MPI's start and end, one line where it fails, one exit code.
#pragma once

#include <functional>
#include <string>

#include "cluster/mpi_session.h"

namespace gigabake::app {

/// Runs `work` on every rank and returns the exit code that rank 0's `work` gave, on every rank. Does not begin where a
/// rank runs another command or another build of the program.
int on_all_ranks(const std::string& command, const std::function<int(MpiSession&)>& work);

}  // namespace gigabake::app
