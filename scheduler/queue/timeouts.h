/// Timeouts of a bake, as set on the command line.
#pragma once

namespace gigabake {

struct Timeouts {
  /// Max time that a bake process with requests in flight may use no CPU time, do no I/O and send no message. After
  /// this time the process counts as hung.
  double no_progress_s = 60;
  /// Max time of one cell or scan, counted from the moment at which it becomes the oldest request in flight.
  double cell_timeout_s = 3600;
  /// Heartbeat timeout of a rank, after which the rank counts as lost.
  double heartbeat_timeout_s = 60;
};

}  // namespace gigabake
