#include "scheduler/queue/schedule.h"

#include <algorithm>
#include <utility>

#include "scheduler/plan/estimate.h"

namespace gigabake {
namespace {

/// Max number of lost workers with the cell in flight that count as coincidence. After more, the cell is retried in
/// isolation.
constexpr int max_coincidental_losses = 1;
/// Max number of pending retries that are examined to find one for a worker. The rest is left to other workers.
constexpr int max_examined = 64;
/// Number of cells of mean cost per worker that are dispatched in the order of cost. The most expensive of them costs
/// twice the mean, and may take four times as long as estimated.
constexpr std::uint64_t mean_cells_at_the_end = 8;

}  // namespace

Schedule::Schedule(const std::vector<CellJob>& jobs, const ScheduleOptions& options)
    : jobs_(jobs), options_(options), order_(jobs), overviews_(jobs), job_(jobs.size()) {
  counts_.pending = jobs.size();
  for (const CellJob& job : jobs) {
    pending_cost_ += cell_cost(job);
    if (is_overview(job)) order_.take(job.id);
  }
}

void Schedule::already_done(std::uint32_t job) {
  if (job_[job].state != JobState::pending) return;
  withdraw(job);
  job_[job].state = JobState::done;
  ++counts_.done;
  overviews_.settled(job, std::nullopt);
}

/// Returns the worker's entry. If the worker is unknown, registers it as alive.
Schedule::Worker& Schedule::known(int worker, double now_s) {
  if (std::size_t(worker) >= workers_.size()) workers_.resize(std::size_t(worker) + 1);
  Worker& w = workers_[std::size_t(worker)];
  if (!w.known) {
    w.known = true;
    w.heard_s = now_s;
    ++live_;
  }
  return w;
}

void Schedule::heard_from(int worker, double now_s) {
  Worker& w = known(worker, now_s);
  w.heard_s = std::max(w.heard_s, now_s);
  if (std::exchange(w.lost, false)) ++live_;
}

std::optional<Assignment> Schedule::next(int worker, double now_s) {
  const Worker& w = known(worker, now_s);
  if (stopped_ || w.lost || w.alone || counts_.pending == 0) return std::nullopt;
  if (w.hand.empty())
    if (const auto job = first_allowed(suspects_, worker)) return dispatch_job(*job, worker, true);
  if (is_reserved(worker, now_s) || w.hand.size() >= std::size_t(options_.slots)) return std::nullopt;
  // An overview is cheap and its children are in this worker's memory, so it does not wait for other cells to finish.
  if (const auto job = overviews_.choose(worker)) return dispatch_job(*job, worker, false);
  if (!has_room(w)) return std::nullopt;
  if (const auto job = first_allowed(again_, worker)) return dispatch_job(*job, worker, false);
  if (const auto job = order_.choose(worker, w.last, is_ending())) return dispatch_job(*job, worker, false);
  return std::nullopt;
}

bool Schedule::is_for_other_overview(int worker, std::uint32_t job) const {
  if (jobs_[job].kept_lod == 0 || live_ < 2) return false;
  constexpr std::size_t few_workers = 16;  // rank 0 then passes on at most 60 MB/s
  return live_ <= few_workers || is_overview(jobs_[job]) || is_ending() || order_.is_claimed_by_other(job, worker);
}

/// Returns true if the worker may get another cell. Several cells in flight keep the worker's stages busy, but near the
/// end of the bake they would leave other workers idle. No worker may then have more cells in flight than an even
/// fraction of the pending cells, by number and by cost.
bool Schedule::has_room(const Worker& w) const {
  if (w.hand.empty()) return true;
  const std::size_t ready = counts_.pending - overviews_.waiting();
  return live_ == 1 || (w.hand.size() < ready / live_ && w.cost <= pending_cost_ / live_);
}

/// Returns true if the pending cells are few enough that their order decides when the last worker finishes.
bool Schedule::is_ending() const {
  return live_ > 1 && pending_cost_ <= mean_cells_at_the_end * order_.mean_cost() * live_;
}

/// Returns true if the worker must become idle for an isolated retry. Such a retry needs an idle worker, usually the
/// worker whose process died. If that worker does not return, the retry would wait until the end of the bake. After a
/// timeout, one worker at a time is therefore left without new cells.
bool Schedule::is_reserved(int worker, double now_s) {
  if (reserved_worker_ && *reserved_worker_ != worker) return false;
  const auto job = first_allowed(suspects_, worker);
  const bool overdue = job && now_s - trouble_.at(*job).since_s >= options_.heartbeat_timeout_s;
  reserved_worker_ = overdue ? std::optional<int>(worker) : std::nullopt;
  return overdue;
}

/// Returns false if the job failed at this worker before, unless it failed at all live workers.
bool Schedule::may_try(int worker, std::uint32_t job) const {
  const std::vector<int>& at = trouble_.at(job).failed_at;
  if (std::find(at.begin(), at.end(), worker) == at.end()) return true;
  const auto lives = [this](int w) { return !workers_[std::size_t(w)].lost; };
  return std::size_t(std::count_if(at.begin(), at.end(), lives)) == live_;
}

std::optional<std::uint32_t> Schedule::first_allowed(const Ranks& waiting, int worker) const {
  int looked_at = 0;
  for (const std::uint32_t rank : waiting) {
    if (may_try(worker, order_.job(rank))) return order_.job(rank);
    if (++looked_at == max_examined) break;
  }
  return std::nullopt;
}

Assignment Schedule::dispatch_job(std::uint32_t job, int worker, bool alone) {
  withdraw(job);
  Job& j = job_[job];
  j.worker = worker;
  j.state = JobState::running;
  ++counts_.running;
  Worker& w = workers_[std::size_t(worker)];
  w.hand.push_back(job);
  w.cost += cell_cost(jobs_[job]);
  if (!is_overview(jobs_[job])) {
    w.last = job;
    order_.claim(job, worker);
  }
  w.alone = alone;
  if (alone && reserved_worker_ == worker) reserved_worker_.reset();
  return {job, ++j.attempt, alone};
}

/// Returns true for the last attempt of a job if the job is still running or was requeued but not dispatched again.
bool Schedule::is_current(int worker, std::uint32_t job, std::uint32_t attempt) const {
  if (job >= job_.size()) return false;
  const Job& j = job_[job];
  return attempt != 0 && j.attempt == attempt && j.worker == worker &&
         (j.state == JobState::running || j.state == JobState::pending);
}

Verdict Schedule::finished(int worker, std::uint32_t job, std::uint32_t attempt, double now_s) {
  heard_from(worker, now_s);
  if (!is_current(worker, job, attempt)) return Verdict::stale;
  if (job_[job].state == JobState::running)
    take_back(workers_[std::size_t(worker)], job);
  else
    withdraw(job);
  job_[job].state = JobState::done;
  ++counts_.done;
  trouble_.erase(job);
  overviews_.settled(job, worker);
  return Verdict::accepted;
}

Verdict Schedule::failed(int worker, std::uint32_t job, std::uint32_t attempt, const std::string& error, double now_s,
                         Retry retry) {
  heard_from(worker, now_s);
  if (!is_current(worker, job, attempt) || job_[job].state != JobState::running) return Verdict::stale;
  take_back(workers_[std::size_t(worker)], job);
  record_failure(job, error, now_s, retry);
  return Verdict::accepted;
}

void Schedule::process_died(int worker, const std::string& why, double now_s) {
  heard_from(worker, now_s);
  overviews_.forget(worker);
  const std::vector<std::uint32_t> jobs = empty_hand(workers_[std::size_t(worker)]);
  for (const std::uint32_t job : jobs) {
    trouble_[job].suspect = true;
    if (jobs.size() == 1)
      record_failure(job, why, now_s);
    else
      put_back(job, now_s);
  }
}

std::vector<int> Schedule::silent(double now_s) {
  std::vector<int> lost;
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    const Worker& w = workers_[i];
    if (w.known && !w.lost && now_s - w.heard_s > options_.heartbeat_timeout_s) lost.push_back(int(i));
  }
  for (const int worker : lost) lose(worker, now_s);
  if (live_ == 0 && !lost.empty()) stop();
  return lost;
}

void Schedule::lose(int worker, double now_s) {
  Worker& w = workers_[std::size_t(worker)];
  w.lost = true;
  --live_;
  overviews_.forget(worker);
  if (reserved_worker_ == worker) reserved_worker_.reset();
  const bool alone = w.alone;
  for (const std::uint32_t job : empty_hand(w)) {
    if (alone) {  // the cell may crash machines, so retries are bounded
      record_failure(job, "worker " + std::to_string(worker) + " stopped sending messages", now_s);
    } else {
      Trouble& t = trouble_[job];
      t.suspect |= ++t.losses > max_coincidental_losses;
      put_back(job, now_s);
    }
  }
}

void Schedule::stop() { stopped_ = true; }

std::vector<std::uint32_t> Schedule::take_quarantined() { return std::exchange(quarantined_, {}); }

/// Removes a pending job from its queue.
void Schedule::withdraw(std::uint32_t job) {
  const auto trouble = trouble_.find(job);
  if (trouble == trouble_.end())
    is_overview(jobs_[job]) ? overviews_.take(job) : order_.take(job);
  else
    (trouble->second.suspect ? suspects_ : again_).erase(order_.rank(job));
  --counts_.pending;
  pending_cost_ -= cell_cost(jobs_[job]);
}

/// Removes a running job from its worker.
void Schedule::take_back(Worker& w, std::uint32_t job) {
  w.hand.erase(std::find(w.hand.begin(), w.hand.end(), job));
  w.cost -= cell_cost(jobs_[job]);
  w.alone = false;
  --counts_.running;
}

std::vector<std::uint32_t> Schedule::empty_hand(Worker& w) {
  const std::vector<std::uint32_t> jobs = w.hand;
  for (const std::uint32_t job : jobs) take_back(w, job);
  return jobs;
}

/// Requeues a job; its failures are kept in trouble_.
void Schedule::put_back(std::uint32_t job, double now_s) {
  Trouble& t = trouble_[job];
  t.since_s = now_s;
  (t.suspect ? suspects_ : again_).insert(order_.rank(job));
  job_[job].state = JobState::pending;
  ++counts_.pending;
  pending_cost_ += cell_cost(jobs_[job]);
}

void Schedule::record_failure(std::uint32_t job, const std::string& error, double now_s, Retry retry) {
  Trouble& t = trouble_[job];
  t.error = error;
  const int worker = job_[job].worker;
  if (std::find(t.failed_at.begin(), t.failed_at.end(), worker) == t.failed_at.end()) t.failed_at.push_back(worker);
  t.is_final = retry == Retry::useless;
  if (++t.strikes < options_.strikes && !t.is_final) return put_back(job, now_s);
  job_[job].state = JobState::failed;
  ++counts_.failed;
  quarantined_.push_back(job);
  overviews_.settled(job, std::nullopt);
}

JobCounts Schedule::counts() const {
  JobCounts c = counts_;
  if (stopped_) c.abandoned = std::exchange(c.pending, 0);
  return c;
}

JobState Schedule::state(std::uint32_t job) const {
  const JobState s = job_[job].state;
  return stopped_ && s == JobState::pending ? JobState::abandoned : s;
}

std::string Schedule::error(std::uint32_t job) const {
  const auto trouble = trouble_.find(job);
  if (trouble == trouble_.end() || trouble->second.strikes == 0) return {};
  const Trouble& t = trouble->second;
  if (t.is_final) return t.error;
  return t.error + (t.strikes == 1 ? " (tried once)" : " (tried " + std::to_string(t.strikes) + " times)");
}

}  // namespace gigabake
