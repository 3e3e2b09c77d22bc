#include "cluster/dispatch/dispatch.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "cluster/dispatch/rank_baker.h"
#include "cluster/dispatch/sent_children.h"
#include "cluster/mpi/collective.h"
#include "cluster/mpi/heartbeat.h"
#include "scheduler/plan/overviews.h"

namespace gigabake {
namespace {

constexpr double heartbeat_interval_s = 1;

/// The executor of the schedule's decisions. It reports events back to the schedule.
class Dispatcher {
 public:
  Dispatcher(RankLink& link, const std::vector<CellJob>& jobs, const DispatchOptions& options,
             const BakeListener& listener)
      : link_(link),
        jobs_(jobs),
        orders_(jobs),
        keep_going_(options.keep_going),
        listener_(listener),
        schedule_(jobs, options),
        children_(jobs),
        deaths_(std::size_t(link.ranks())),
        hosts_(std::size_t(link.ranks())) {}

  DispatchResult run(const std::vector<CellReport>& done) {
    for (const CellReport& report : done) {
      orders_.is_done(report);
      schedule_.already_done(report.id);
    }
    for (int rank = 0; rank < link_.ranks(); ++rank) schedule_.heard_from(rank, link_.now_s());
    hosts_[0] = host_name();
    listener_(WorkerJoined{0, hosts_[0]});
    try {
      while (!schedule_.is_over()) {
        step();
        link_.wait();
      }
    } catch (...) {
      stop_all();  // no rank may wait for a master that failed
      throw;
    }
    stop_all();
    result_.counts = schedule_.counts();
    result_.lost_ranks.assign(lost_.begin(), lost_.end());
    result_.is_drained = link_.is_drain_requested() && result_.counts.abandoned != 0;
    return std::move(result_);
  }

 private:
  void step() {
    check_drain();
    listener_(BakeAlive{});
    send_heartbeats();
    dispatch_cells();
    while (const auto message = link_.receive()) take(*message);
    schedule_.heard_from(0, link_.now_s());
    for (const int rank : schedule_.silent(link_.now_s())) {
      lost_.insert(rank);
      listener_(WorkerLost{rank});
      has_new_events_ = true;
    }
    for (const std::uint32_t job : schedule_.take_quarantined()) quarantine(job);
  }

  void check_drain() {
    if (!link_.is_drain_requested()) return;
    if (!std::exchange(is_draining_, true)) listener_(StateEntered{BakeState::draining});
    schedule_.stop();
  }

  /// Sends heartbeats to the other ranks. A rank that receives no heartbeat from rank 0 ends the launch.
  void send_heartbeats() {
    if (link_.now_s() - shown_s_ < heartbeat_interval_s) return;
    shown_s_ = link_.now_s();
    for (int rank = 1; rank < link_.ranks(); ++rank)
      if (!lost_.contains(rank)) link_.send(rank, tag_alive, {});
  }

  /// Dispatches cells in rounds of one cell per rank, so that the most expensive cells are distributed. Rank 0 is last
  /// in a round because it has the most other work.
  void dispatch_cells() {
    if (!std::exchange(has_new_events_, false)) return;
    for (bool gave = true; gave;) {
      gave = false;
      for (int rank = link_.ranks(); rank-- > 0;) {
        if (lost_.contains(rank)) continue;
        if (const auto assignment = schedule_.next(rank, link_.now_s())) {
          listener_(JobDispatched{assignment->job, rank});
          link_.send(rank, tag_job, order_bytes(deaths_[std::size_t(rank)], order_of(*assignment, rank)));
          gave = true;
        }
      }
    }
  }

  BakeOrder order_of(const Assignment& assignment, int rank) {
    BakeOrder order{orders_.order(assignment.job), assignment.attempt,
                    schedule_.is_for_other_overview(rank, assignment.job)};
    if (is_overview(order.job)) order.children = children_.take_for(assignment.job, rank);
    return order;
  }

  void take(const Message& message) {
    hear(message.from);
    if (message.tag == tag_report) {
      BakeAnswer answer = answer_from_bytes(message.bytes);
      result_.work += answer.work;
      children_.keep(message.from, answer.report, std::move(answer.child));
      take(message.from, answer.report, answer.attempt);
    }
    if (message.tag == tag_device) take_device(message.from, device_from_bytes(message.bytes));
    if (message.tag == tag_died) report_end(message.from, std::string(message.bytes.begin(), message.bytes.end()));
    if (message.tag == tag_alive) take_heartbeat(message);
  }

  void hear(int rank) {
    schedule_.heard_from(rank, link_.now_s());
    if (lost_.erase(rank) == 0) return;
    has_new_events_ = true;
    listener_(WorkerJoined{rank, hosts_[std::size_t(rank)]});
  }

  /// Records the device of a rank. If only some ranks have a device, the others are reported, because their cells take
  /// longer.
  void take_device(int rank, const DeviceAnswer& answer) {
    if (!answer.error.empty()) throw std::runtime_error(answer.error);
    if (rank == 0) result_.no_device = answer.choice.reason;
    if (answer.choice.device)
      ++result_.ranks_with_device;
    else if (!answer.choice.reason.empty())
      without_device_.emplace_back(rank, answer.choice.reason);
    if (result_.ranks_with_device == 0) return;
    for (const auto& [other, reason] : std::exchange(without_device_, {}))
      listener_(WarningLine{"rank " + std::to_string(other) + " on " + hosts_[std::size_t(other)] +
                            " uses the CPU: " + reason});
  }

  void take_heartbeat(const Message& message) {
    const Heartbeat sign = heartbeat_from_bytes(message.bytes);
    result_.peak_bytes = std::max(result_.peak_bytes, sign.peak_bytes);
    std::string& known = hosts_[std::size_t(message.from)];
    if (known.empty()) listener_(WorkerJoined{message.from, sign.host});
    known = sign.host;
  }

  void report_end(int rank, const std::string& why) {
    ++deaths_[std::size_t(rank)];
    schedule_.process_died(rank, why, link_.now_s());
    listener_(ProcessDied{rank, why});
    has_new_events_ = true;
  }

  void take(int rank, const CellReport& report, std::uint32_t attempt) {
    has_new_events_ = true;
    const bool refused = report.outcome == CellOutcome::refused;
    const bool failed = refused || report.outcome == CellOutcome::failed;
    const Retry retry = refused ? Retry::useless : Retry::worth_it;
    const Verdict verdict = failed ? schedule_.failed(rank, report.id, attempt, report.error, link_.now_s(), retry)
                                   : schedule_.finished(rank, report.id, attempt, link_.now_s());
    if (verdict == Verdict::stale) return;
    if (failed) return listener_(AttemptFailed{report.id});
    orders_.is_done(report);
    listener_(JobFinished{report, orders_.order(report.id)});
    result_.reports.push_back(report);
  }

  void quarantine(std::uint32_t job) {
    CellReport report;
    report.id = job;
    report.error = schedule_.error(job);
    listener_(JobQuarantined{report, jobs_.at(job)});
    if (!keep_going_) schedule_.stop();
    result_.reports.push_back(std::move(report));
  }

  void stop_all() {
    for (int rank = 1; rank < link_.ranks(); ++rank) link_.send(rank, tag_stop, {});
  }

  RankLink& link_;
  const std::vector<CellJob>& jobs_;
  OverviewJobs orders_;
  const bool keep_going_;
  const BakeListener& listener_;
  Schedule schedule_;
  SentChildren children_;
  std::vector<std::uint32_t> deaths_;  ///< number of deaths of each rank's bake process that rank 0 has counted
  std::vector<std::string> hosts_;     ///< host name of each rank; empty until the rank has sent a heartbeat
  std::set<int> lost_;
  std::vector<std::pair<int, std::string>> without_device_;  ///< ranks to report, with the reason
  DispatchResult result_;
  double shown_s_ = -heartbeat_interval_s;
  bool has_new_events_ = true, is_draining_ = false;
};

}  // namespace

DispatchResult dispatch(RankLink& link, const std::vector<CellJob>& jobs, const std::vector<CellReport>& done,
                        const DispatchOptions& options, const BakeListener& listener) {
  return Dispatcher(link, jobs, options, listener).run(done);
}

}  // namespace gigabake
