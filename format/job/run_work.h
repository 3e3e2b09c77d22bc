/// The work of bake processes on a run, which rank 0 sums for the report.
#pragma once

#include "core/base/work_counts.h"
#include "format/system/meters/stage_clock.h"

namespace gigabake {

/// The work of a bake process between two of its answers, or the sum over answers and processes.
struct RunWork {
  WorkCounts counts;
  StageTimes stages;
  double cpu_s = 0;  ///< of all threads, user and system

  RunWork& operator+=(const RunWork& other);
};

/// A meter of the work of this process. Not thread-safe.
class RunWorkMeter {
 public:
  /// Returns the work since the previous call; the first call returns the work since the start of the process.
  RunWork next();

 private:
  RunWork before_;
};

/// Returns the CPU seconds of this process, user and system.
double process_cpu_s();

}  // namespace gigabake
