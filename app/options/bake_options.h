/// The options that `plan` and `bake` share.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "cluster/bake.h"

namespace gigabake::app {

/// The request as the parser fills it, and as typed what is more than one value; request() completes it.
struct BakeOptions {
  BakeRequest asked;  ///< whose defaults the help says
  std::string source, out, metrics, report, voxel_size, channels, lattice_origin, origin;
  std::optional<std::uint64_t> memory_bytes;
  bool json = false, quiet = false;
  std::optional<bool> log_time;  ///< none: where standard error is not a terminal

  BakeOptions();
  void add_to(CLI::App& command);
  /// Collective. Returns this rank's own request. Errors  CollectiveUsageError: what was expected of which option;
  /// CollectiveFailure: rank 0 finds that SCENE is no source.
  BakeRequest request_of(MpiSession& mpi) const;
  /// Of a process that bakes alone. Errors  UsageError and InputError, as request_of().
  BakeRequest request() const;

 private:
  BakeRequest checked_request() const;
};

}  // namespace gigabake::app
