/// One bake on all ranks with its messages and its report, for the commands `bake` and `edit`.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cluster/bake/bake.h"
#include "cluster/process/child_process.h"

namespace gigabake::app {

struct BakeOutput {
  bool json = false, quiet = false;
  std::optional<bool> log_time;  ///< unset: log times if standard error is not a terminal
  std::string report;            ///< file for the report; empty: none
};

/// Starts this rank's bake process before MPI, so that its device starts concurrently. Returns null where that is not
/// possible: the launcher does not state the rank on this host.
std::unique_ptr<ChildProcess> start_bake_process(Backend backend, const std::vector<int>& gpus);

/// Bakes on every rank, with its bake process `early` if that is not null, and prints the result on rank 0. Returns the
/// exit code. Collective call.
/// Errors  The errors of bake(), except Stopped.
int run_bake(const BakeRequest& request, const BakeOutput& output, MpiSession& mpi,
             std::unique_ptr<ChildProcess> early = nullptr);

}  // namespace gigabake::app
