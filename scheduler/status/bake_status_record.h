/// Accumulates the events of a bake and computes its status.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "format/job/cell_job.h"
#include "scheduler/status/bake_event.h"
#include "scheduler/status/bake_status.h"
#include "scheduler/status/time_left.h"

namespace gigabake {

/// Work of the last minute, in buckets of one second.
class RecentWork {
 public:
  void add(double now_s, std::uint64_t voxels, std::uint64_t bytes);
  /// Returns the throughput of the last minute, or since start_s if that is later.
  /// Range   start_s < now_s; else the result is zero.
  Throughput at(double start_s, double now_s) const;

 private:
  struct Bucket {
    double second = 0;
    std::uint64_t cells = 0, voxels = 0, bytes = 0;
  };
  std::deque<Bucket> buckets_;
};

/// Identity of the bake that a status describes.
struct BakeIdentity {
  std::string out, host;
  std::int64_t pid = 0;
  int ranks = 1;
};

/// Record of a bake's events. Jobs are indices into the plan, and workers are ranks. The caller passes the Unix time as
/// `now_s`, so that a test can replay a bake. Pass only results that the Schedule accepted, no stale results.
/// Exact   Deterministic: the same calls give the same status.
/// Cost    Under 60 bytes per job; an event is O(cells in flight at one worker), at() is O(workers).
/// Errors  std::out_of_range if a job is not in the plan.
class BakeStatusRecord {
 public:
  BakeStatusRecord(BakeIdentity identity, double now_s);

  /// Records the event by calling one of the functions below; ignores events that do not change the status.
  void add(const BakeEvent& event, double now_s);

  void scanned(std::size_t tiles_done, std::size_t tiles);
  /// Records the plan and enters BakeState::baking. `costs` has the relative cost of each job, in any unit.
  void planned(const std::vector<CellJob>& jobs, std::vector<double> costs, double now_s);
  /// Records a loss that is no cell, for example a tile that cannot be read.
  void lost(const std::string& name, const std::string& line);
  /// Records that an earlier run has baked the job.
  void already_done(std::uint32_t job);
  /// Records that a worker has joined or rejoined.
  void worker_joined(int worker, const std::string& host, double now_s);
  void handed_out(std::uint32_t job, int worker, double now_s);
  /// Records a cell that was baked or found empty.
  void cell_done(const CellReport& report, double now_s);
  /// Records a failed attempt; the cell is pending again unless quarantined() follows.
  void attempt_failed(std::uint32_t job, double now_s);
  void quarantined(std::uint32_t job, const std::string& line, double now_s);
  /// Records that a worker's bake process died and restarts. The worker's cells in flight are pending again.
  void process_died(int worker, double now_s);
  /// Records a heartbeat timeout of a worker. The worker's cells in flight are pending again.
  void worker_lost(int worker, double now_s);
  void enter(BakeState state);
  void fail(const std::string& reason);

  BakeState state() const { return status_.state; }
  BakeStatus at(double now_s) const;

 private:
  static constexpr std::int32_t nobody = -1;
  struct Cell {
    std::int32_t holder = nobody;
    bool settled = false;  ///< no further events change it
  };
  struct Worker {
    bool known = false, lost = false;
    std::string host;
    double since_s = 0;
    std::vector<std::uint32_t> hand;
  };

  void begin_dispatch(const DispatchBegan& began, double now_s);
  Worker& worker(int rank);
  void release(std::uint32_t job, double now_s);
  void drop_hand(Worker& w, double now_s);
  bool settle(std::uint32_t job, double now_s);
  /// Returns true for cells; overviews are dispatched like cells, but not counted as cells.
  bool is_cell(std::uint32_t job) const { return job < first_overview_; }
  void note_slow(const CellReport& report, std::int32_t holder);
  std::optional<double> left_s(double now_s) const;

  BakeStatus status_;                 ///< the status, except the members that at() computes
  std::vector<std::string> names_;    ///< names of the jobs
  std::uint32_t first_overview_ = 0;  ///< index of the first overview job
  std::vector<double> costs_;
  std::vector<Cell> cells_;
  std::vector<Worker> workers_;  ///< per rank
  RecentWork recent_;
  TimeLeft time_left_;  ///< estimate from the jobs in flight and finished at ranks
  double planned_s_ = 0, cost_left_ = 0;
};

}  // namespace gigabake
