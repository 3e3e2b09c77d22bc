/// Dispatch of cells: rank 0 sends jobs to every rank's bake process, its own included, and collects the reports.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cluster/mpi/mpi_session.h"
#include "cluster/mpi/rank_link.h"
#include "cluster/process/bake_process.h"
#include "format/job/cell_job.h"
#include "scheduler/queue/schedule.h"
#include "scheduler/status/bake_event.h"

namespace gigabake {

struct DispatchOptions : ScheduleOptions {
  bool keep_going = true;  ///< continue after a cell failed permanently; if false, no further cells are dispatched
};

struct DispatchResult {
  std::vector<CellReport> reports;  ///< in the order in which they are received; a job without a report was not baked
  JobCounts counts;
  std::vector<int> lost_ranks;   ///< ranks lost at the end; if there are any, no collective call may follow
  std::uint64_t peak_bytes = 0;  ///< max over the bake processes of ranks other than 0
  RunWork work;                  ///< of all ranks' bake processes, including failed attempts
  int ranks_with_device = 0;     ///< ranks that reported a device before the end
  std::string no_device;         ///< reason why rank 0 has no device
  bool is_drained = false;       ///< the bake ended on request before all cells were baked
};

/// Dispatches jobs. Call it on rank 0 only. `done` contains the reports of jobs that an earlier run has baked.
/// `listener` receives the events of the dispatch, the first of which is WorkerJoined. Sends tag_stop to all other
/// ranks at the end, also if it throws.
/// Exact   Each job is reported at most once, even if ranks die or rejoin.
/// Errors  InputError: a rank's message is malformed. std::runtime_error: a rank has no device although one was
///         requested, or its bake process cannot start.
DispatchResult dispatch(RankLink& link, const std::vector<CellJob>& jobs, const std::vector<CellReport>& done,
                        const DispatchOptions& options, const BakeListener& listener);

/// Runs the worker loop of a rank other than 0: bakes the cells that rank 0 sends until tag_stop arrives.
/// Errors  RankLost: no message from rank 0 within four times heartbeat_timeout_s. Before rank 0's first message, the
///         timeout is that of a collective call. After RankLost, no collective call may follow.
void work(MpiSession& mpi, BakeProcess& process, double heartbeat_timeout_s);

}  // namespace gigabake
