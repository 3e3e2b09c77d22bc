#include "cluster/master_bake.h"

#include <algorithm>
#include <string>
#include <sys/resource.h>

#include "cluster/drain.h"
#include "format/error.h"
#include "scheduler/estimate.h"
#include "scheduler/merge.h"

namespace gigabake {
namespace {

/// One cell read, one computed, and where a device bakes two written.
constexpr int cells_in_hand = 4;

ScheduleOptions schedule_options(const BakeRequest& request) {
  ScheduleOptions options;
  options.slots = cells_in_hand;
  options.silence_s = request.silence_s;
  return options;
}

std::uint64_t peak_bytes_here() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::uint64_t(usage.ru_maxrss) * 1024;
}

std::vector<double> costs_of(const BakePlan& plan) {
  std::vector<double> costs;
  for (const CellJob& job : plan.jobs) costs.push_back(double(cell_cost(job)));
  return costs;
}

void add_times(const std::vector<CellReport>& reports, BakeSummary& summary) {
  for (const CellReport& r : reports) {
    summary.read_s += r.read_s;
    summary.kernel_s += r.kernel_s;
    summary.write_s += r.write_s;
    summary.peak_kernel_bytes = std::max(summary.peak_kernel_bytes, r.peak_bytes);
    summary.cells_empty += r.outcome == CellOutcome::empty;
    summary.cells_on_device += r.on_device;
    summary.bad_uv += r.bad_uv;
  }
}

}  // namespace

void refuse(const BakeRequest& request, const std::vector<SceneLoss>& losses, bool nothing_baked) {
  if (losses.empty() || (request.keep_going && !nothing_baked)) return;
  const std::size_t more = losses.size() - 1;
  throw InputError(request.source, "",
                   std::string(nothing_baked ? "nothing could be baked" : "stopped (--no-keep-going)") + ": " +
                       losses[0].name + ": " + losses[0].reason +
                       (more == 0 ? "" : " (and " + std::to_string(more) + " more losses)"));
}

MasterBake::MasterBake(const BakeRequest& request, const SceneSources& sources, const BakePlan& plan,
                       const OutputFolder& out, const BakeProgress& progress, StatusFeed& feed, BakeSummary& summary)
    : request_(request),
      sources_(sources),
      plan_(plan),
      out_(out),
      progress_(progress),
      feed_(feed),
      summary_(summary) {}

void MasterBake::run(MpiSession& mpi, BakeProcess& process) {
  for (const SceneLoss& l : plan_.losses) feed_.record().lost(l.name, l.reason);
  feed_.record().planned(plan_.jobs, costs_of(plan_), unix_now_s());
  feed_.publish();
  const DispatchResult result = dispatch(mpi, plan_.jobs, {}, process, schedule_options(request_), *this);
  summary_.cells_planned = plan_.jobs.size();
  summary_.is_drained = is_drain_asked() && result.counts.abandoned != 0;
  summary_.lost_ranks = result.lost_ranks.size();
  summary_.peak_process_bytes = std::max(result.peak_bytes, peak_bytes_here());
  add_times(result.reports, summary_);
  summary_.scene = merge(plan_, result.reports, sources_.origin, request_.parameters);
  publish();
}

bool MasterBake::turn() {
  if (is_drain_asked() && feed_.record().state() == BakeState::baking) {
    feed_.record().enter(BakeState::draining);
    progress_.noted("asked to end: the cells in hand are finished, no new ones begun");
  }
  feed_.turn();
  return !is_drain_asked();
}

void MasterBake::joined(int rank, const std::string& host) { feed_.record().worker_joined(rank, host, unix_now_s()); }

void MasterBake::handed_out(std::uint32_t job, int rank) { feed_.record().handed_out(job, rank, unix_now_s()); }

bool MasterBake::finished(const CellReport& report) {
  feed_.record().cell_done(report, unix_now_s());
  progress_.cell_done(report, plan_.jobs[report.id]);
  return true;
}

void MasterBake::attempt_failed(std::uint32_t job) { feed_.record().attempt_failed(job, unix_now_s()); }

bool MasterBake::set_aside(const CellReport& report) {
  feed_.record().set_aside(report.id, report.error, unix_now_s());
  progress_.cell_done(report, plan_.jobs[report.id]);
  return request_.keep_going;
}

void MasterBake::process_died(int rank, const std::string& why) {
  ++summary_.process_deaths;
  feed_.record().process_died(rank, unix_now_s());
  progress_.noted("the bake process of rank " + std::to_string(rank) + " is started again: " + why);
}

void MasterBake::lost(int rank) {
  feed_.record().worker_lost(rank, unix_now_s());
  progress_.noted("nothing heard of rank " + std::to_string(rank) + "; its cells are baked elsewhere");
}

void MasterBake::publish() {
  feed_.record().enter(BakeState::publishing);
  feed_.publish();
  out_.expect_shards(summary_.scene);
  if (summary_.is_drained && out_.has_whole_scene()) return;  // until this one is whole, too
  refuse(request_, summary_.scene.losses, summary_.scene.cells.empty() && !summary_.is_drained);
  if (!summary_.scene.cells.empty()) out_.publish(summary_.scene);
}

}  // namespace gigabake
