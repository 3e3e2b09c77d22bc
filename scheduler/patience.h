/// Timeouts of a bake, from the command line to their users.
#pragma once

namespace gigabake {

struct Patience {
  /// Max time without progress of a bake process with requests in flight: no CPU time, no I/O and no message. After it
  /// the process counts as hung.
  double stall_s = 60;
  /// Max time of one cell or scan, counted from when it becomes the oldest in flight.
  double cell_timeout_s = 3600;
  /// Heartbeat timeout of a rank, after which the rank counts as lost.
  double silence_s = 60;
};

}  // namespace gigabake
