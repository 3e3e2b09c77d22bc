#include "scheduler/status/bake_status_record.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "scheduler/plan/estimate.h"

namespace gigabake {
namespace {

constexpr double minute_s = 60;

Throughput over(double seconds, double cells, double voxels, double bytes) {
  if (!(seconds > 0)) return {};
  return {cells / seconds, voxels / seconds, bytes / seconds};
}

}  // namespace

void RecentWork::add(double now_s, std::uint64_t voxels, std::uint64_t bytes) {
  const double second = std::floor(now_s);
  if (buckets_.empty() || buckets_.back().second != second) buckets_.push_back({second});
  Bucket& b = buckets_.back();
  ++b.cells;
  b.voxels += voxels;
  b.bytes += bytes;
  while (buckets_.front().second < second - minute_s) buckets_.pop_front();
}

Throughput RecentWork::at(double start_s, double now_s) const {
  Bucket sum;
  for (const Bucket& b : buckets_) {
    if (b.second < now_s - minute_s) continue;
    sum.cells += b.cells;
    sum.voxels += b.voxels;
    sum.bytes += b.bytes;
  }
  return over(std::min(minute_s, now_s - start_s), double(sum.cells), double(sum.voxels), double(sum.bytes));
}

BakeStatusRecord::BakeStatusRecord(BakeIdentity identity, double now_s) {
  status_.out = std::move(identity.out);
  status_.host = std::move(identity.host);
  status_.pid = identity.pid;
  status_.ranks = identity.ranks;
  status_.started_s = now_s;
}

void BakeStatusRecord::add(const BakeEvent& event, double now_s) {
  if (const auto* scan = std::get_if<TilesScanned>(&event)) return scanned(scan->done, scan->all);
  if (const auto* began = std::get_if<DispatchBegan>(&event)) return begin_dispatch(*began, now_s);
  if (const auto* joined = std::get_if<WorkerJoined>(&event)) return worker_joined(joined->rank, joined->host, now_s);
  if (const auto* sent = std::get_if<JobDispatched>(&event)) return handed_out(sent->job, sent->rank, now_s);
  if (const auto* done = std::get_if<JobFinished>(&event)) return cell_done(done->report, now_s);
  if (const auto* failed = std::get_if<AttemptFailed>(&event)) return attempt_failed(failed->job, now_s);
  if (const auto* bad = std::get_if<JobQuarantined>(&event))
    return quarantined(bad->report.id, bad->report.error, now_s);
  if (const auto* died = std::get_if<ProcessDied>(&event)) return process_died(died->rank, now_s);
  if (const auto* silent = std::get_if<WorkerLost>(&event)) return worker_lost(silent->rank, now_s);
  if (const auto* entered = std::get_if<StateEntered>(&event)) return enter(entered->state);
}

void BakeStatusRecord::begin_dispatch(const DispatchBegan& began, double now_s) {
  for (const SceneLoss& loss : began.plan.losses) lost(loss.name, loss.reason);
  std::vector<double> costs;
  for (const CellJob& job : began.plan.jobs) costs.push_back(double(cell_cost(job)));
  planned(began.plan.jobs, std::move(costs), now_s);
  for (const CellReport& report : began.reused) already_done(report.id);
}

void BakeStatusRecord::scanned(std::size_t tiles_done, std::size_t tiles) {
  status_.tiles_scanned = tiles_done;
  status_.tiles = tiles;
}

void BakeStatusRecord::planned(const std::vector<CellJob>& jobs, std::vector<double> costs, double now_s) {
  names_.clear();
  for (const CellJob& job : jobs) names_.push_back(job.name);
  first_overview_ = std::uint32_t(std::find_if(jobs.begin(), jobs.end(), is_overview) - jobs.begin());
  costs_ = std::move(costs);
  cells_.assign(jobs.size(), {});
  cost_left_ = std::accumulate(costs_.begin(), costs_.end(), 0.0);
  planned_s_ = now_s;
  status_.cells.planned = first_overview_;
  status_.state = BakeState::baking;
}

void BakeStatusRecord::lost(const std::string& name, const std::string& line) {
  ++status_.failures;
  if (status_.first_failures.size() < max_failures_listed) status_.first_failures.push_back({name, line});
}

void BakeStatusRecord::already_done(std::uint32_t job) {
  if (settle(job, planned_s_)) status_.cells.taken_over += is_cell(job);
}

void BakeStatusRecord::worker_joined(int rank, const std::string& host, double now_s) {
  Worker& w = worker(rank);
  if (!w.known || w.lost) w.since_s = now_s;
  w.known = true;
  w.lost = false;
  w.host = host;
}

void BakeStatusRecord::handed_out(std::uint32_t job, int rank, double now_s) {
  release(job, now_s);
  cells_.at(job).holder = rank;
  Worker& w = worker(rank);
  w.known = true;
  w.lost = false;
  w.since_s = now_s;
  w.hand.push_back(job);
  status_.cells.running += is_cell(job);
  time_left_.begins(std::size_t(rank), now_s);
}

void BakeStatusRecord::cell_done(const CellReport& report, double now_s) {
  const std::int32_t holder = cells_.at(report.id).holder;
  if (holder != nobody && !cells_.at(report.id).settled)
    time_left_.ends(std::size_t(holder), costs_.at(report.id), now_s);
  if (!settle(report.id, now_s)) return;
  (report.outcome == CellOutcome::empty ? status_.cells.empty : status_.cells.done) += is_cell(report.id);
  const std::uint64_t voxels = report.cell.own_voxels();
  status_.voxels += voxels;
  status_.bytes += report.cell.bytes;
  status_.read_s += report.read_s;
  status_.kernel_s += report.kernel_s;
  status_.write_s += report.write_s;
  recent_.add(now_s, voxels, report.cell.bytes);
  note_slow(report, holder);
}

void BakeStatusRecord::attempt_failed(std::uint32_t job, double now_s) {
  release(job, now_s);
  ++status_.cells.failed_attempts;
}

void BakeStatusRecord::quarantined(std::uint32_t job, const std::string& line, double now_s) {
  if (!settle(job, now_s)) return;
  status_.cells.quarantined += is_cell(job);
  lost((is_cell(job) ? "cell " : "parent ") + names_[job], line);
}

void BakeStatusRecord::process_died(int rank, double now_s) {
  drop_hand(worker(rank), now_s);
  ++status_.process_restarts;
}

void BakeStatusRecord::worker_lost(int rank, double now_s) {
  Worker& w = worker(rank);
  drop_hand(w, now_s);
  w.known = true;
  w.lost = true;
  ++status_.workers_lost;
}

void BakeStatusRecord::enter(BakeState state) { status_.state = state; }

void BakeStatusRecord::fail(const std::string& reason) {
  status_.state = BakeState::failed;
  status_.reason = reason;
}

BakeStatus BakeStatusRecord::at(double now_s) const {
  BakeStatus s = status_;
  s.updated_s = now_s;
  s.cells.pending =
      s.cells.planned - s.cells.taken_over - s.cells.running - s.cells.done - s.cells.empty - s.cells.quarantined;
  if (status_.state != BakeState::scanning) {
    s.recent = recent_.at(planned_s_, now_s);
    s.overall = over(now_s - planned_s_, double(s.cells.done + s.cells.empty), double(s.voxels), double(s.bytes));
  }
  s.left_s = left_s(now_s);
  for (std::size_t rank = 0; rank < workers_.size(); ++rank) {
    const Worker& w = workers_[rank];
    if (!w.known) continue;
    s.workers.push_back({int(rank), w.host, w.lost, w.since_s, {}});
    for (const std::uint32_t job : w.hand) s.workers.back().cells.push_back(names_[job]);
  }
  return s;
}

BakeStatusRecord::Worker& BakeStatusRecord::worker(int rank) {
  if (workers_.size() <= std::size_t(rank)) workers_.resize(std::size_t(rank) + 1);
  return workers_[std::size_t(rank)];
}

void BakeStatusRecord::release(std::uint32_t job, double now_s) {
  Cell& cell = cells_.at(job);
  if (cell.holder == nobody) return;
  Worker& w = worker(cell.holder);
  std::erase(w.hand, job);
  w.since_s = now_s;
  if (w.hand.empty()) time_left_.rests(std::size_t(cell.holder));
  cell.holder = nobody;
  status_.cells.running -= is_cell(job);
}

void BakeStatusRecord::drop_hand(Worker& w, double now_s) {
  const std::vector<std::uint32_t> hand = w.hand;
  for (const std::uint32_t job : hand) release(job, now_s);
}

/// Marks a job as final. Returns false if it was already final.
bool BakeStatusRecord::settle(std::uint32_t job, double now_s) {
  Cell& cell = cells_.at(job);
  if (cell.settled) return false;
  release(job, now_s);
  cell.settled = true;
  cost_left_ -= costs_.at(job);
  return true;
}

void BakeStatusRecord::note_slow(const CellReport& r, std::int32_t holder) {
  SlowCell cell{names_[r.id], r.read_s + r.kernel_s + r.write_s, {}};
  if (holder != nobody) cell.rank = holder;
  auto& slowest = status_.slowest;
  const auto faster = [&](const SlowCell& other) { return other.seconds < cell.seconds; };
  slowest.insert(std::find_if(slowest.begin(), slowest.end(), faster), std::move(cell));
  if (slowest.size() > max_slow_cells) slowest.pop_back();
}

/// Returns the remaining time by cost, because cells differ by orders of magnitude.
std::optional<double> BakeStatusRecord::left_s(double now_s) const {
  if (status_.state == BakeState::complete || status_.state == BakeState::incomplete) return 0;
  if (status_.state != BakeState::baking) return {};
  return time_left_.left_s(std::max(0.0, cost_left_), now_s);
}

}  // namespace gigabake
