/// Bakes a terrain in virtual time with the real plan and the real schedule; workers are simulated.
#pragma once

#include <cstdint>

#include "bench/schedule_model.h"

namespace gigabake::bench {

struct ScheduleBenchRequest {
  std::uint32_t cells = 1000000;
  int workers = 1000;
  std::uint64_t seed = 1;
  ScheduleOptions schedule;
  int deaths = 0;         ///< number of bake processes that die, at random times
  int silences = 0;       ///< number of workers that send no heartbeat for twice the heartbeat timeout
  int failing_cells = 0;  ///< number of cells that report an error on each attempt
  int killing_cells = 0;  ///< number of cells that kill their process on each attempt
};

struct ScheduleBench {
  std::uint32_t cells = 0;
  int workers = 0;
  std::uint64_t seed = 0;
  double plan_s = 0;         ///< real seconds of make_plan()
  double makespan_s = 0;     ///< virtual seconds until the bake ends
  double lower_bound_s = 0;  ///< bound for any order: the cells' slowest stages per worker, or the longest cell
  std::uint64_t dispatches = 0, retries = 0, stale = 0;
  std::uint64_t followers = 0;  ///< cells that share a tile with the worker's previous cell
  int lost_workers = 0;
  JobCounts counts;
  double schedule_s = 0;             ///< real: time in calls of the schedule, including 40 ns per call for timing
  std::uint64_t peak_rss_bytes = 0;  ///< of the whole process so far
  bool differ = false;               ///< a cell was done twice, or is neither done nor failed

  double ratio() const { return lower_bound_s > 0 ? makespan_s / lower_bound_s : 1; }
  double dispatches_per_s() const { return double(dispatches) / schedule_s; }
};

/// Simulates a bake. A worker has three cells in flight, one in each stage, in the order of their dispatch. Messages
/// take message_s; rank 0 itself takes no time. The model ignores repeated reads of tiles, stages that compete for
/// cores, and workers of unequal speed.
ScheduleBench bench_schedule(const ScheduleBenchRequest& request);

}  // namespace gigabake::bench
