/// The options that `plan` and `bake` share.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "app/options/area_options.h"
#include "app/options/raster_options.h"
#include "cluster/bake/bake.h"

namespace gigabake::app {

/// A request that the parser fills, and the texts of options that need further parsing. request() combines them.
struct BakeOptions {
  BakeRequest asked;  ///< its defaults are shown in the help
  std::string source, out, metrics, report, voxel_size, channels, lattice_origin, origin;
  std::optional<std::uint64_t> memory_bytes;
  RasterArguments raster;
  AreaOptions area;
  bool json = false, quiet = false;
  std::optional<int> ranks;      ///< --ranks of `bake`; unset: one per GPU of the host
  std::optional<bool> log_time;  ///< unset: log times if standard error is not a terminal

  BakeOptions();
  void add_to(CLI::App& command);
  /// Collective. Returns this rank's own request.
  /// Errors  CollectiveUsageError: the option and its expected value. CollectiveFailure: rank 0 finds that SOURCE is a
  ///         baked scene or a shard.
  BakeRequest request_of(MpiSession& mpi) const;
  /// Returns the request of a process that bakes without MPI.
  /// Errors  UsageError and InputError, for the same reasons as request_of().
  BakeRequest request() const;

 private:
  BakeRequest checked_request() const;
};

}  // namespace gigabake::app
