/// Who bakes which cell, and what becomes of cells whose worker errs, dies or falls silent. Decides only: whoever talks
/// to the workers tells it what happened and does what it answers.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "format/job/cell_job.h"
#include "scheduler/parent_queue.h"
#include "scheduler/patience.h"
#include "scheduler/work_order.h"

namespace gigabake {

/// Of a worker that bakes: one cell read, one computed, one written, and as many at hand.
inline constexpr int worker_slots = 6;
/// Where a device computes: four read, one computed, three brought, four written, and as many at hand as above.
inline constexpr int device_worker_slots = 15;

/// devices: how many workers compute on one.
inline int slots_of_worker(int devices) { return devices != 0 ? device_worker_slots : worker_slots; }

struct ScheduleOptions {
  int strikes = 3;                          ///< attempts that may go wrong before a cell is set aside
  int slots = worker_slots;                 ///< cells in hand of one worker
  double silence_s = Patience{}.silence_s;  ///< a worker that nothing was heard of for longer is lost
};

enum class JobState : std::uint8_t {
  pending,    ///< waits, perhaps not for the first time
  running,    ///< in a worker's hand
  done,       ///< baked, now or by an earlier run
  failed,     ///< set aside: error() says why
  abandoned,  ///< waited when the schedule was stopped
};

/// The attempt is the fence: it goes to the worker and comes back with the result; only the last one counts.
struct Assignment {
  std::uint32_t job = 0;
  std::uint32_t attempt = 0;  ///< 1 is the first
  bool alone = false;         ///< a suspect: the worker holds nothing else until this is back
  friend bool operator==(const Assignment&, const Assignment&) = default;
};

/// Whether a cell that failed may come out otherwise another time.
enum class Retry : std::uint8_t { worth_it, useless };

enum class Verdict : std::uint8_t {
  accepted,
  stale,  ///< of an attempt that does not count any more: nothing has changed
};

struct JobCounts {
  std::size_t pending = 0, running = 0, done = 0, failed = 0, abandoned = 0;
  friend bool operator==(const JobCounts&, const JobCounts&) = default;
};

/// Workers are numbers from 0; one is known, and alive, from the first call that names it: name all of them before the
/// first next(), so that few cells are shared out well. Time is monotonic seconds of any origin.
/// A parent is handed out when all of its children are done or set aside; before cells, and if it can be to the worker
/// that finished the last of them, whose memory still has its file.
/// Exact   A value: the same calls give the same answers; no clock, no chance.
/// Ends    A cell is handed out at most 2 + strikes times, so every job ends done, failed or abandoned.
/// Cost    28 bytes a job, more for those in trouble; a call is O(log jobs), silent() O(workers).
class Schedule {
 public:
  /// jobs outlive it.
  Schedule(const std::vector<CellJob>& jobs, const ScheduleOptions& options);

  /// Before the first next(): an earlier run has baked it.
  void already_done(std::uint32_t job);

  /// The worker is there. One that was lost is welcome back; what it had belongs to others by now.
  void heard_from(int worker, double now_s);

  /// The next cell for this worker, if it should have one now. Ask for each worker until there is none: at the start,
  /// and again for all of them whenever something came back.
  std::optional<Assignment> next(int worker, double now_s);

  /// Accepted: the cell is done. Good news of a lost worker's cell count as long as nobody else was given it.
  Verdict finished(int worker, std::uint32_t job, std::uint32_t attempt, double now_s);
  /// Accepted: a strike; the cell is tried again, elsewhere if somebody else is left, or set aside, at once where
  /// another try is useless.
  Verdict failed(int worker, std::uint32_t job, std::uint32_t attempt, const std::string& error, double now_s,
                 Retry retry = Retry::worth_it);
  /// The process that baked for this worker is gone with all that it had. A cell that was alone with it gets a strike;
  /// several are suspects. The worker itself lives and may be given more.
  void process_died(int worker, const std::string& why, double now_s);
  /// Workers that are lost since the last call. Their cells go back without a strike; twice so makes a suspect, and
  /// only a suspect that was alone with its worker gets one. When nobody is left the schedule stops.
  std::vector<int> silent(double now_s);
  /// Hands out nothing more; what is out may still come back.
  void stop();

  /// Jobs set aside since the last call, in the order in which it happened.
  std::vector<std::uint32_t> take_set_aside();

  /// Nothing is out, and nothing will be handed out.
  bool is_over() const { return counts_.running == 0 && (counts_.pending == 0 || stopped_); }
  /// Cells in hand of workers that live.
  std::size_t out() const { return counts_.running; }
  JobCounts counts() const;
  JobState state(std::uint32_t job) const;
  /// Of a job in trouble: its last error and, unless another try is useless, how often it went wrong. Empty for others.
  std::string error(std::uint32_t job) const;

 private:
  struct Job {
    std::uint32_t attempt = 0;
    std::int32_t worker = -1;  ///< of the last attempt
    JobState state = JobState::pending;
  };
  /// Kept of jobs that went wrong until they are done.
  struct Trouble {
    int strikes = 0, losses = 0;
    bool suspect = false, is_final = false;
    double since_s = 0;          ///< when it came back
    std::vector<int> failed_at;  ///< workers, each once
    std::string error;
  };
  struct Worker {
    bool known = false, lost = false;
    bool alone = false;  ///< with a suspect
    double heard_s = 0;
    std::uint64_t cost = 0;           ///< of what it has in hand
    std::vector<std::uint32_t> hand;  ///< jobs
    std::optional<std::uint32_t> last;
  };
  using Ranks = std::set<std::uint32_t>;

  Worker& known(int worker, double now_s);
  bool has_room(const Worker& w) const;
  bool is_kept_free(int worker, double now_s);
  bool may_try(int worker, std::uint32_t job) const;
  std::optional<std::uint32_t> first_allowed(const Ranks& waiting, int worker) const;
  Assignment hand_out(std::uint32_t job, int worker, bool alone);

  bool is_current(int worker, std::uint32_t job, std::uint32_t attempt) const;
  void withdraw(std::uint32_t job);
  void take_back(Worker& w, std::uint32_t job);
  std::vector<std::uint32_t> empty_hand(Worker& w);
  void put_back(std::uint32_t job, double now_s);
  void strike(std::uint32_t job, const std::string& error, double now_s, Retry retry = Retry::worth_it);
  void lose(int worker, double now_s);

  const std::vector<CellJob>& jobs_;
  ScheduleOptions options_;
  WorkOrder order_;       ///< of jobs that were never handed out
  ParentQueue parents_;   ///< those that were never handed out
  Ranks again_;           ///< pending, tried before
  Ranks suspects_;        ///< pending, to be tried alone
  std::vector<Job> job_;  ///< states as if stop() did not exist
  std::unordered_map<std::uint32_t, Trouble> trouble_;
  std::vector<Worker> workers_;
  std::size_t live_ = 0;
  JobCounts counts_;
  std::uint64_t pending_cost_ = 0;
  std::optional<int> kept_free_;  ///< the one worker that is given nothing so that it can take a suspect
  std::vector<std::uint32_t> set_aside_;
  bool stopped_ = false;
};

}  // namespace gigabake
