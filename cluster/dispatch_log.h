/// Writes down what happens while cells are baked: in the journal, in the status, and for rank 0's own log.
#pragma once

#include <cstdint>
#include <string>

#include "cluster/bake.h"
#include "cluster/status_feed.h"
#include "scheduler/journal.h"

namespace gigabake {

/// What rank 0 says where a rank's bake process ended, during the scan of tiles as while cells are baked.
std::string restart_line(int rank, const std::string& why);

/// Rank 0's. Errors  None of its own: what cannot be written costs one line, not the bake.
class DispatchLog {
 public:
  /// All of them outlive it. The feed knows of the plan already.
  DispatchLog(const BakePlan& plan, Journal& journal, StatusFeed& feed, const BakeProgress& progress)
      : plan_(plan), journal_(journal), feed_(feed), progress_(progress) {}

  /// Every few milliseconds.
  void turn() { feed_.turn(); }
  /// The cells in hand are finished, and no new ones begun. Says so once.
  void draining();
  /// A rank is there, or there again.
  void joined(int rank, const std::string& host);
  void handed_out(std::uint32_t job, int rank);
  /// A cell is baked or empty. order: the job as it was handed out.
  void finished(const CellReport& report, const CellJob& order);
  /// An attempt failed; the cell is tried again, unless set_aside() follows.
  void attempt_failed(std::uint32_t job);
  /// A cell failed for good; the report says why.
  void set_aside(const CellReport& report);
  /// A rank's bake process is gone; its cells are tried again.
  void process_died(int rank, const std::string& why);
  /// Nothing was heard of a rank for too long; its cells are tried elsewhere.
  void lost(int rank);

 private:
  void write_down(const CellReport& report, const CellJob& order);

  const BakePlan& plan_;
  Journal& journal_;
  StatusFeed& feed_;
  const BakeProgress& progress_;
};

}  // namespace gigabake
