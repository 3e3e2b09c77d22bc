/// Keeps a bake's status: told what happens, it says how things stand.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "format/job/cell_job.h"
#include "scheduler/bake_status.h"
#include "scheduler/time_left.h"

namespace gigabake {

/// What was baked during the last minute, in buckets of a second.
class RecentWork {
 public:
  void add(double now_s, std::uint64_t voxels, std::uint64_t bytes);
  /// A bake younger than a minute is as old as it is. Range  start_s < now_s, else nothing.
  Throughput at(double start_s, double now_s) const;

 private:
  struct Bucket {
    double second = 0;
    std::uint64_t cells = 0, voxels = 0, bytes = 0;
  };
  std::deque<Bucket> buckets_;
};

/// Who a status is about.
struct BakeIdentity {
  std::string out, host;
  std::int64_t pid = 0;
  int ranks = 1;
};

/// Jobs are indices into the plan, workers are ranks, now_s is Unix time: a test can replay a bake. Tell it what the
/// Schedule accepted; stale results are none of its business.
/// Exact   A value: the same calls give the same status.
/// Cost    Under 60 bytes a job; an event is O(cells in one hand), at() O(workers).
/// Errors  std::out_of_range: a job that is not in the plan.
class BakeStatusRecord {
 public:
  BakeStatusRecord(BakeIdentity identity, double now_s);

  void surveyed(std::size_t tiles_done, std::size_t tiles);
  /// Baking begins. costs: of each job beside the others, in any unit.
  void planned(const std::vector<CellJob>& jobs, std::vector<double> costs, double now_s);
  /// Something other than a cell will be missing: a tile that cannot be read.
  void lost(const std::string& name, const std::string& line);
  /// An earlier run has baked it.
  void already_done(std::uint32_t job);
  /// The worker is there, or there again.
  void worker_joined(int worker, const std::string& host, double now_s);
  void handed_out(std::uint32_t job, int worker, double now_s);
  /// Baked, or found empty.
  void cell_done(const CellReport& report, double now_s);
  /// The cell waits again, unless set_aside() follows.
  void attempt_failed(std::uint32_t job, double now_s);
  void set_aside(std::uint32_t job, const std::string& line, double now_s);
  /// The worker's bake process is gone and comes back; the cells in hand wait again.
  void process_died(int worker, double now_s);
  /// The worker fell silent; the cells in hand wait again.
  void worker_lost(int worker, double now_s);
  void enter(BakeState state);
  void fail(const std::string& reason);

  BakeState state() const { return status_.state; }
  BakeStatus at(double now_s) const;

 private:
  static constexpr std::int32_t nobody = -1;
  struct Cell {
    std::int32_t holder = nobody;
    bool settled = false;  ///< nothing more will happen to it
  };
  struct Worker {
    bool known = false, lost = false;
    std::string host;
    double since_s = 0;
    std::vector<std::uint32_t> hand;
  };

  Worker& worker(int rank);
  void release(std::uint32_t job, double now_s);
  void drop_hand(Worker& w, double now_s);
  bool settle(std::uint32_t job, double now_s);
  /// Parents are work as cells are, and are not counted among them.
  bool is_cell(std::uint32_t job) const { return job < first_parent_; }
  void note_slow(const CellReport& report, std::int32_t holder);
  std::optional<double> left_s(double now_s) const;

  BakeStatus status_;               ///< all but what at() works out
  std::vector<std::string> names_;  ///< of jobs
  std::uint32_t first_parent_ = 0;  ///< jobs from here on
  std::vector<double> costs_;
  std::vector<Cell> cells_;
  std::vector<Worker> workers_;  ///< by rank
  RecentWork recent_;
  TimeLeft time_left_;  ///< cells in the hands of ranks
  double planned_s_ = 0, cost_left_ = 0;
};

}  // namespace gigabake
