/// The status of a bake as another process observes it.
#pragma once

#include <filesystem>

#include "scheduler/status/bake_status.h"

namespace gigabake {

struct ObservedStatus {
  BakeStatus status;
  double now_s = 0;          ///< Unix time of the observation
  bool interrupted = false;  ///< the bake has not recorded its end, but the writer of its status seems to be dead

  /// Returns whether the bake has not ended.
  bool is_running() const { return !interrupted && !is_over(status.state); }
};

/// Reads the status of the bake in `out`.
/// Errors  The errors of read_status().
ObservedStatus observe_status(const std::filesystem::path& out);

}  // namespace gigabake
