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

  BakeOptions();
  void add_to(CLI::App& command);
  /// Errors  UsageError: what was expected of which option.
  BakeRequest request() const;
};

}  // namespace gigabake::app
