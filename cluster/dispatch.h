/// Handing out cells: rank 0 keeps every rank's bake process, its own included, supplied and collects the reports.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cluster/bake_process.h"
#include "cluster/dispatch_log.h"
#include "cluster/mpi_session.h"
#include "cluster/rank_link.h"
#include "format/job/cell_job.h"
#include "scheduler/schedule.h"

namespace gigabake {

struct DispatchOptions : ScheduleOptions {
  bool keep_going = true;  ///< after a cell failed for good; else nothing more is handed out
};

struct DispatchResult {
  std::vector<CellReport> reports;  ///< in the order in which they came; a job without one was not baked
  JobCounts counts;
  std::vector<int> lost_ranks;   ///< that were still lost at the end: no collective call may follow
  std::uint64_t peak_bytes = 0;  ///< of the largest bake process of another rank
  bool is_drained = false;       ///< ended on request with cells left
};

/// Rank 0. done: what an earlier run has baked. Every other rank is told to stop at the end, also where it
/// throws.
/// Exact   Each job is reported at most once, whatever dies or comes back late.
/// Errors  InputError: a rank's message is malformed.
DispatchResult dispatch(RankLink& link, const std::vector<CellJob>& jobs, const std::vector<CellReport>& done,
                        const DispatchOptions& options, DispatchLog& log);

/// Every other rank: bakes what it is given until told to stop.
/// Errors  RankLost: nothing heard of rank 0 for four times silence_s (before its first word: for as long as
///         a collective call waits). No collective call may follow.
void work(MpiSession& mpi, BakeProcess& process, double silence_s);

}  // namespace gigabake
