/// Records the events of dispatch in the journal, the status and rank 0's log.
#pragma once

#include <cstdint>
#include <string>

#include "cluster/bake/bake.h"
#include "cluster/bake/status_feed.h"
#include "scheduler/journal/journal.h"

namespace gigabake {

/// Returns the line that rank 0 prints when a rank's bake process ended, during the scan of tiles and during the bake.
std::string restart_line(int rank, const std::string& why);

/// Event log of rank 0.
/// Errors  None: a failed write prints one line; the bake continues.
class DispatchLog {
 public:
  /// All arguments must outlive the log. The feed already has the plan.
  DispatchLog(const BakePlan& plan, Journal& journal, StatusFeed& feed, const BakeProgress& progress)
      : plan_(plan), journal_(journal), feed_(feed), progress_(progress) {}

  /// Updates the status; call it every few milliseconds.
  void turn() { feed_.turn(); }
  /// Reports once that the cells in flight will be finished and no further cells started.
  void draining();
  /// Records that a rank has joined or rejoined.
  void joined(int rank, const std::string& host);
  void handed_out(std::uint32_t job, int rank);
  /// Records that a cell is baked or empty. order: the dispatched job.
  void finished(const CellReport& report, const CellJob& order);
  /// Records a failed attempt; the cell is retried unless set_aside() follows.
  void attempt_failed(std::uint32_t job);
  /// Records a permanent failure of a cell; the report has the reason.
  void set_aside(const CellReport& report);
  /// Records that a rank's bake process ended; its cells are retried.
  void process_died(int rank, const std::string& why);
  /// Records a heartbeat timeout of a rank; its cells are retried on other ranks.
  void lost(int rank);

 private:
  void write_down(const CellReport& report, const CellJob& order);

  const BakePlan& plan_;
  Journal& journal_;
  StatusFeed& feed_;
  const BakeProgress& progress_;
};

}  // namespace gigabake
