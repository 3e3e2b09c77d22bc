/// Assignment of cells to workers, including retries after errors, deaths and heartbeat timeouts. The schedule only
/// decides: the caller reports events and executes the decisions.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "format/job/cell_job.h"
#include "scheduler/queue/overview_queue.h"
#include "scheduler/queue/timeouts.h"
#include "scheduler/queue/work_order.h"

namespace gigabake {

/// Cells in flight per CPU worker that computes one cell at a time: one read, one computed, one written, four
/// published, and three queued.
inline constexpr int worker_slots = 10;
/// Cells in flight per device worker: six read, one computed, three read back, four written, four published, and three
/// queued.
inline constexpr int device_worker_slots = 21;

/// Returns the max number of cells in flight per worker, which computes on a device or on the CPU. A CPU worker
/// computes and writes the given numbers of cells concurrently.
inline int slots_of_worker(bool has_device, int computed = 1, int written = 1) {
  return has_device ? device_worker_slots : worker_slots + (computed - 1) + (written - 1);
}

struct ScheduleOptions {
  int strikes = 3;                                              ///< failed attempts after which a cell is quarantined
  int slots = worker_slots;                                     ///< max cells in flight per worker
  double heartbeat_timeout_s = Timeouts{}.heartbeat_timeout_s;  ///< heartbeat timeout after which a worker is lost
};

enum class JobState : std::uint8_t {
  pending,    ///< queued, including retries
  running,    ///< in flight at a worker
  done,       ///< baked, by this run or an earlier one
  failed,     ///< quarantined: error() has the reason
  abandoned,  ///< was pending when the schedule was stopped
};

/// A dispatched job. The attempt number serves as an epoch: it is sent to the worker and returned with the result, and
/// only the last attempt's result counts.
struct Assignment {
  std::uint32_t job = 0;
  std::uint32_t attempt = 0;  ///< the first is 1
  bool alone = false;         ///< isolated retry: the worker has no other cell in flight
  friend bool operator==(const Assignment&, const Assignment&) = default;
};

/// Hint whether another attempt at a failed cell may succeed.
enum class Retry : std::uint8_t { worth_it, useless };

enum class Verdict : std::uint8_t {
  accepted,
  stale,  ///< the attempt is superseded; the call has no effect
};

struct JobCounts {
  std::size_t pending = 0, running = 0, done = 0, failed = 0, abandoned = 0;
  friend bool operator==(const JobCounts&, const JobCounts&) = default;
};

/// Scheduler of jobs. Workers are numbers from 0. A worker is known and alive from the first call that names it. Name
/// all workers before the first next(), so that even a small number of cells is distributed evenly. Time is monotonic
/// seconds from an arbitrary origin. An overview is dispatched when all of its children are done or quarantined. Ready
/// overviews are dispatched before cells, to the worker that finished most of the children: these are still in the
/// worker's memory.
/// Exact   Deterministic: the same calls give the same answers. The schedule uses no clock and no random numbers.
/// Ends    A cell is dispatched at most 2 + `strikes` times, so every job ends as done, failed or abandoned.
/// Cost    52 bytes per job, more for jobs with failures; a call is O(log jobs), silent() is O(workers).
class Schedule {
 public:
  /// `jobs` must outlive the schedule.
  Schedule(const std::vector<CellJob>& jobs, const ScheduleOptions& options);

  /// Records that an earlier run has baked the job. Call it before the first next().
  void already_done(std::uint32_t job);

  /// Records a heartbeat. A lost worker rejoins, without its former cells: these were requeued when it was lost.
  void heard_from(int worker, double now_s);

  /// Returns the next cell for this worker, if it should get one now. Call it for all workers until it returns nullopt
  /// for each: at the start, and again after every result or death of a process.
  std::optional<Assignment> next(int worker, double now_s);

  /// Returns true if another worker may make the overview above this job, which `worker` has just got. The worker then
  /// sends the overview's input along with its report.
  bool is_for_other_overview(int worker, std::uint32_t job) const;

  /// Records a finished cell. Accepts a result of a lost worker if the cell was not dispatched again.
  Verdict finished(int worker, std::uint32_t job, std::uint32_t attempt, double now_s);
  /// Records a failed attempt. An accepted attempt counts as a failure of the cell: the cell is retried, preferably at
  /// another worker, or quarantined. The cell is quarantined immediately if `retry` is useless.
  Verdict failed(int worker, std::uint32_t job, std::uint32_t attempt, const std::string& error, double now_s,
                 Retry retry = Retry::worth_it);
  /// Records the death of the worker's bake process, which loses all its cells. A cell that was the only one in the
  /// process gets a failure; several cells are marked for isolated retries. The worker stays alive and may get cells.
  void process_died(int worker, const std::string& why, double now_s);
  /// Marks workers as lost whose heartbeat timed out since the last call, and returns them. Their cells are requeued
  /// without a failure. A cell requeued twice this way is marked for an isolated retry, and only an isolated cell gets
  /// a failure. Stops the schedule if no worker is left.
  std::vector<int> silent(double now_s);
  /// Stops dispatch; running cells may still finish.
  void stop();

  /// Returns the jobs quarantined since the last call, in order.
  std::vector<std::uint32_t> take_quarantined();

  /// Returns true if no job is running and none will be dispatched.
  bool is_over() const { return counts_.running == 0 && (counts_.pending == 0 || stopped_); }
  /// Returns the number of cells in flight at live workers.
  std::size_t out() const { return counts_.running; }
  JobCounts counts() const;
  JobState state(std::uint32_t job) const;
  /// Returns the last error of a job with failures, and the number of failures unless a retry is useless. Returns an
  /// empty string for other jobs.
  std::string error(std::uint32_t job) const;

 private:
  struct Job {
    std::uint32_t attempt = 0;
    std::int32_t worker = -1;  ///< worker of the last attempt
    JobState state = JobState::pending;
  };
  /// The state of a job with failures, kept until the job is done.
  struct Trouble {
    int strikes = 0, losses = 0;
    bool suspect = false, is_final = false;
    double since_s = 0;          ///< time of the last requeue
    std::vector<int> failed_at;  ///< workers at which the job failed, without duplicates
    std::string error;
  };
  struct Worker {
    bool known = false, lost = false;
    bool alone = false;  ///< has an isolated retry in flight
    double heard_s = 0;
    std::uint64_t cost = 0;           ///< cost of its cells in flight
    std::vector<std::uint32_t> hand;  ///< jobs in flight
    std::optional<std::uint32_t> last;
  };
  using Ranks = std::set<std::uint32_t>;

  Worker& known(int worker, double now_s);
  bool has_room(const Worker& w) const;
  bool is_ending() const;
  bool is_reserved(int worker, double now_s);
  bool may_try(int worker, std::uint32_t job) const;
  std::optional<std::uint32_t> first_allowed(const Ranks& waiting, int worker) const;
  Assignment dispatch_job(std::uint32_t job, int worker, bool alone);

  bool is_current(int worker, std::uint32_t job, std::uint32_t attempt) const;
  void withdraw(std::uint32_t job);
  void take_back(Worker& w, std::uint32_t job);
  std::vector<std::uint32_t> empty_hand(Worker& w);
  void put_back(std::uint32_t job, double now_s);
  void record_failure(std::uint32_t job, const std::string& error, double now_s, Retry retry = Retry::worth_it);
  void lose(int worker, double now_s);

  const std::vector<CellJob>& jobs_;
  ScheduleOptions options_;
  WorkOrder order_;          ///< order of the jobs that were never dispatched
  OverviewQueue overviews_;  ///< overviews that were never dispatched
  Ranks again_;              ///< pending retries
  Ranks suspects_;           ///< pending isolated retries
  std::vector<Job> job_;     ///< `abandoned` never occurs here: state() derives it from stopped_
  std::unordered_map<std::uint32_t, Trouble> trouble_;
  std::vector<Worker> workers_;
  std::size_t live_ = 0;
  JobCounts counts_;
  std::uint64_t pending_cost_ = 0;
  std::optional<int>
      reserved_worker_;  ///< the worker that gets no cells, so that it becomes free for an isolated retry
  std::vector<std::uint32_t> quarantined_;
  bool stopped_ = false;
};

}  // namespace gigabake
