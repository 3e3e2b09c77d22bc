/// One bake on all ranks with its messages and its report, for the commands `bake` and `edit`.
#pragma once

#include <optional>
#include <string>

#include "cluster/bake/bake.h"

namespace gigabake::app {

struct BakeOutput {
  bool json = false, quiet = false;
  std::optional<bool> log_time;  ///< unset: log times if standard error is not a terminal
  std::string report;            ///< file for the report; empty: none
};

/// Bakes on every rank and prints the result on rank 0. Returns the exit code. Collective call.
/// Errors  The errors of bake(), except Stopped.
int run_bake(const BakeRequest& request, const BakeOutput& output, MpiSession& mpi);

}  // namespace gigabake::app
