#include "cluster/dispatch.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <string>
#include <utility>
#include <variant>

#include "cluster/collective.h"
#include "cluster/signs_of_life.h"
#include "cluster/tags.h"
#include "lattice/bytes.h"

namespace gigabake {
namespace {

constexpr std::chrono::milliseconds longest_wait{2};
constexpr double between_signs_s = 1;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Does what the schedule decides, and tells it what happened.
class Master {
 public:
  Master(MpiSession& mpi, const std::vector<CellJob>& jobs, BakeProcess& process, const ScheduleOptions& options,
         DispatchWatcher& watcher)
      : mpi_(mpi),
        jobs_(jobs),
        process_(process),
        watcher_(watcher),
        schedule_(jobs, options),
        deaths_(std::size_t(mpi.ranks())),
        hosts_(std::size_t(mpi.ranks())) {}

  DispatchResult run(const std::vector<std::uint32_t>& already_done) {
    for (const std::uint32_t job : already_done) schedule_.already_done(job);
    for (int rank = 0; rank < mpi_.ranks(); ++rank) schedule_.heard_from(rank, now_s());
    watcher_.joined(0, host_name());
    try {
      while (!schedule_.is_over()) {
        step();
        process_.wait(longest_wait);
      }
    } catch (...) {
      stop_all();  // nobody may wait for a master that has given up
      throw;
    }
    stop_all();
    result_.counts = schedule_.counts();
    result_.lost_ranks.assign(lost_.begin(), lost_.end());
    result_.peak_bytes = std::max(result_.peak_bytes, process_.peak_bytes());
    return std::move(result_);
  }

 private:
  void step() {
    if (!watcher_.turn()) schedule_.stop();
    show_life();
    give_out();
    while (auto event = process_.poll()) take(*event);
    while (auto message = mpi_.poll()) take(*message);
    schedule_.heard_from(0, now_s());
    for (const int rank : schedule_.silent(now_s())) {
      lost_.insert(rank);
      watcher_.lost(rank);
      something_came_back_ = true;
    }
    for (const std::uint32_t job : schedule_.take_set_aside()) set_aside(job);
  }

  /// A rank that hears nothing of rank 0 ends the launch.
  void show_life() {
    if (now_s() - shown_s_ < between_signs_s) return;
    shown_s_ = now_s();
    for (int rank = 1; rank < mpi_.ranks(); ++rank)
      if (!lost_.contains(rank)) mpi_.send(rank, tag_alive, {});
  }

  /// A round gives each rank one cell, so that the costliest are shared out; 0 last, for it has most to do.
  void give_out() {
    if (!std::exchange(something_came_back_, false)) return;
    for (bool gave = true; gave;) {
      gave = false;
      for (int rank = mpi_.ranks(); rank-- > 0;) {
        if (lost_.contains(rank)) continue;
        if (const auto assignment = schedule_.next(rank, now_s())) {
          give(rank, *assignment);
          gave = true;
        }
      }
    }
  }

  void give(int rank, const Assignment& assignment) {
    watcher_.handed_out(assignment.job, rank);
    if (rank == 0) return process_.submit(jobs_[assignment.job], assignment.attempt);
    ByteWriter writer;
    writer.put(deaths_[std::size_t(rank)]);
    std::vector<std::uint8_t> bytes = writer.take();
    const std::vector<std::uint8_t> order = to_bytes(BakeOrder{jobs_[assignment.job], assignment.attempt});
    bytes.insert(bytes.end(), order.begin(), order.end());
    mpi_.send(rank, tag_job, std::move(bytes));
  }

  void take(const BakeProcess::Event& event) {
    if (const auto* baked = std::get_if<BakeProcess::Baked>(&event)) take(0, baked->report, baked->attempt);
    if (const auto* died = std::get_if<BakeProcess::Died>(&event)) bury(0, died->why);
  }

  void take(const Message& message) {
    hear(message.from);
    if (message.tag == tag_report) {
      const BakeAnswer answer = answer_from_bytes(message.bytes);
      take(message.from, answer.report, answer.attempt);
    }
    if (message.tag == tag_died) bury(message.from, std::string(message.bytes.begin(), message.bytes.end()));
    if (message.tag == tag_alive) look_at_life(message);
  }

  void hear(int rank) {
    schedule_.heard_from(rank, now_s());
    if (lost_.erase(rank) == 0) return;
    something_came_back_ = true;
    watcher_.joined(rank, hosts_[std::size_t(rank)]);
  }

  void look_at_life(const Message& message) {
    const SignOfLife sign = sign_from_bytes(message.bytes);
    result_.peak_bytes = std::max(result_.peak_bytes, sign.peak_bytes);
    std::string& known = hosts_[std::size_t(message.from)];
    if (known.empty()) watcher_.joined(message.from, sign.host);
    known = sign.host;
  }

  void bury(int rank, const std::string& why) {
    ++deaths_[std::size_t(rank)];
    schedule_.process_died(rank, why, now_s());
    watcher_.process_died(rank, why);
    something_came_back_ = true;
  }

  void take(int rank, const CellReport& report, std::uint32_t attempt) {
    something_came_back_ = true;
    const bool refused = report.outcome == CellOutcome::refused;
    const bool failed = refused || report.outcome == CellOutcome::failed;
    const Retry retry = refused ? Retry::useless : Retry::worth_it;
    const Verdict verdict = failed ? schedule_.failed(rank, report.id, attempt, report.error, now_s(), retry)
                                   : schedule_.finished(rank, report.id, attempt, now_s());
    if (verdict == Verdict::stale) return;
    if (failed) return watcher_.attempt_failed(report.id);
    if (!watcher_.finished(report)) schedule_.stop();
    result_.reports.push_back(report);
  }

  void set_aside(std::uint32_t job) {
    CellReport report;
    report.id = job;
    report.error = schedule_.error(job);
    if (!watcher_.set_aside(report)) schedule_.stop();
    result_.reports.push_back(std::move(report));
  }

  void stop_all() {
    for (int rank = 1; rank < mpi_.ranks(); ++rank) mpi_.send(rank, tag_stop, {});
  }

  MpiSession& mpi_;
  const std::vector<CellJob>& jobs_;
  BakeProcess& process_;
  DispatchWatcher& watcher_;
  Schedule schedule_;
  std::vector<std::uint32_t> deaths_;  ///< of each rank's bake process, as far as rank 0 has heard
  std::vector<std::string> hosts_;     ///< of each rank, once it has said so
  std::set<int> lost_;
  DispatchResult result_;
  double shown_s_ = 0;
  bool something_came_back_ = true;
};

}  // namespace

DispatchResult dispatch(MpiSession& mpi, const std::vector<CellJob>& jobs,
                        const std::vector<std::uint32_t>& already_done, BakeProcess& process,
                        const ScheduleOptions& options, DispatchWatcher& watcher) {
  return Master(mpi, jobs, process, options, watcher).run(already_done);
}

}  // namespace gigabake
