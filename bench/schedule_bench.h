/// Bakes a terrain in virtual time: the real plan and the real schedule, with workers that are only numbers.
#pragma once

#include <cstdint>

#include "bench/schedule_model.h"

namespace gigabake::bench {

struct ScheduleBenchRequest {
  std::uint32_t cells = 1000000;
  int workers = 1000;
  std::uint64_t seed = 1;
  ScheduleOptions schedule;
  int deaths = 0;         ///< of baking processes, at random times
  int silences = 0;       ///< workers that nobody hears of for twice the silence that is suffered
  int failing_cells = 0;  ///< report an error each time
  int killing_cells = 0;  ///< kill their process each time
};

struct ScheduleBench {
  std::uint32_t cells = 0;
  int workers = 0;
  std::uint64_t seed = 0;
  double plan_s = 0;         ///< real: make_plan
  double makespan_s = 0;     ///< virtual
  double lower_bound_s = 0;  ///< no order of work is faster: the slowest stage over all workers, or the longest cell
  std::uint64_t dispatches = 0, retries = 0, stale = 0;
  std::uint64_t followers = 0;  ///< cells that shared a tile with what their worker took before
  int lost_workers = 0;
  JobCounts counts;
  double schedule_s = 0;             ///< real: inside the schedule's calls, with the stop watch's own 40 ns each
  std::uint64_t peak_rss_bytes = 0;  ///< of the whole process so far
  bool differ = false;               ///< a cell was done twice, or is neither done nor failed

  double ratio() const { return lower_bound_s > 0 ? makespan_s / lower_bound_s : 1; }
  double dispatches_per_s() const { return double(dispatches) / schedule_s; }
};

/// A worker reads, computes and writes three cells at once, one in each stage, in the order in which they came.
/// Messages take message_s; rank 0 itself takes no time. Not modelled: tiles read anew, stages that take cores from
/// each other, workers of unequal speed.
ScheduleBench bench_schedule(const ScheduleBenchRequest& request);

}  // namespace gigabake::bench
