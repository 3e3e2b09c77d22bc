/// Handing out cells: rank 0 keeps every rank's bake process, its own included, supplied and collects the reports.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "cluster/bake_process.h"
#include "cluster/mpi_session.h"
#include "format/cell_job.h"
#include "scheduler/schedule.h"

namespace gigabake {

/// What rank 0 wants to know while it goes on. Each is called on its one thread.
struct DispatchEvents {
  std::function<void(std::uint32_t job, int rank)> on_start = [](std::uint32_t, int) {};
  /// A cell is decided: baked, empty, or failed for good. False: hand out nothing more.
  std::function<bool(const CellReport&, int rank)> on_report;
  /// A rank's bake process is gone; its cells are tried again.
  std::function<void(int rank, const std::string& why)> on_death = [](int, const std::string&) {};
  /// Nothing was heard of a rank for too long; its cells are tried elsewhere.
  std::function<void(int rank)> on_lost = [](int) {};
  /// Asked all the time. True: hand out nothing more, finish what is out.
  std::function<bool()> should_drain = [] { return false; };
};

struct DispatchResult {
  std::vector<CellReport> reports;  ///< in the order in which they came; a job without one was not baked
  JobCounts counts;
  bool is_drained = false;       ///< should_drain() said so before all was handed out
  std::vector<int> lost_ranks;   ///< that were still lost at the end: no collective call may follow
  std::uint64_t peak_bytes = 0;  ///< of the largest bake process
};

/// Rank 0. already_done: jobs that an earlier run has baked.
/// Exact   Each job is reported at most once, whatever dies or comes back late.
DispatchResult dispatch(MpiSession& mpi, const std::vector<CellJob>& jobs,
                        const std::vector<std::uint32_t>& already_done, BakeProcess& process,
                        const ScheduleOptions& options, const DispatchEvents& events);

/// Every other rank: bakes what it is given until told to stop.
void work(MpiSession& mpi, BakeProcess& process);

}  // namespace gigabake
