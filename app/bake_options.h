/// The options that `plan` and `bake` share.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "cluster/bake.h"

namespace gigabake::app {

/// Text as typed; request() turns it into values.
struct BakeOptions {
  std::string source, out, metrics, report, voxel_size, surface = "area", mip = "coverage", lattice_origin, origin, up,
                                                        backend = "auto", codec = "deflate",
                                                        channels = "rgba,normal,facing";
  std::vector<int> gpus;
  std::uint32_t cell_voxels = 1024;
  bool local = false, keep_going = true, prune = false, json = false, quiet = false;
  std::uint32_t max_error = 0;
  int threads = 0;
  double stall_s = 60, cell_timeout_s = 3600, silence_s = 60;
  std::optional<std::uint64_t> memory_bytes;

  void add_to(CLI::App& command);
  /// Errors  UsageError: what was expected of which option.
  BakeRequest request() const;
  Backend wanted_backend() const;
};

}  // namespace gigabake::app
