/// Timeouts of a bake, from the command line to their users.
#pragma once

namespace gigabake {

struct Timeouts {
  /// Max time without progress of a bake process with requests in flight: no CPU time, no I/O and no message. After it
  /// the process counts as hung.
  double no_progress_s = 60;
  /// Max time of one cell or scan, counted from when it becomes the oldest in flight.
  double cell_timeout_s = 3600;
  /// Heartbeat timeout of a rank, after which the rank counts as lost.
  double heartbeat_timeout_s = 60;
};

}  // namespace gigabake
