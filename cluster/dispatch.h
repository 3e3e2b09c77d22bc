/// Handing out cells: rank 0 keeps every rank's bake process, its own included, supplied and collects the reports.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cluster/bake_process.h"
#include "cluster/mpi_session.h"
#include "format/job/cell_job.h"
#include "scheduler/schedule.h"

namespace gigabake {

/// Who is told what happens, on rank 0's one thread.
class DispatchWatcher {
 public:
  virtual ~DispatchWatcher() = default;

  /// Every few milliseconds. False: hand out nothing more, finish what is out.
  virtual bool turn() = 0;
  /// A rank is there, or there again.
  virtual void joined(int rank, const std::string& host) = 0;
  virtual void handed_out(std::uint32_t job, int rank) = 0;
  /// A cell is baked or empty. False: as turn().
  virtual bool finished(const CellReport& report) = 0;
  /// An attempt failed; the cell is tried again, unless set_aside() follows.
  virtual void attempt_failed(std::uint32_t job) = 0;
  /// A cell failed for good; the report says why. False: as turn().
  virtual bool set_aside(const CellReport& report) = 0;
  /// A rank's bake process is gone; its cells are tried again.
  virtual void process_died(int rank, const std::string& why) = 0;
  /// Nothing was heard of a rank for too long; its cells are tried elsewhere.
  virtual void lost(int rank) = 0;
};

struct DispatchResult {
  std::vector<CellReport> reports;  ///< in the order in which they came; a job without one was not baked
  JobCounts counts;
  std::vector<int> lost_ranks;   ///< that were still lost at the end: no collective call may follow
  std::uint64_t peak_bytes = 0;  ///< of the largest bake process
};

/// Rank 0. already_done: jobs that an earlier run has baked.
/// Exact   Each job is reported at most once, whatever dies or comes back late.
DispatchResult dispatch(MpiSession& mpi, const std::vector<CellJob>& jobs,
                        const std::vector<std::uint32_t>& already_done, BakeProcess& process,
                        const ScheduleOptions& options, DispatchWatcher& watcher);

/// Every other rank: bakes what it is given until told to stop.
/// Errors  RankLost: nothing heard of rank 0 for four times silence_s (before its first word: for as long as
///         a collective call waits). No collective call may follow.
void work(MpiSession& mpi, BakeProcess& process, double silence_s);

}  // namespace gigabake
