#include "cluster/master_bake.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <sys/resource.h>

#include "cluster/drain.h"
#include "lattice/error.h"
#include "scheduler/estimate.h"
#include "scheduler/merge.h"
#include "scheduler/prior.h"

namespace gigabake {
namespace {

ScheduleOptions schedule_options(const BakeRequest& request, const BakeSummary& summary) {
  ScheduleOptions options;
  if (summary.ranks_with_device != 0) options.slots = device_worker_slots;
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
  PriorResults prior;
  {
    const JournalContent content = read_journal(out_.journal());
    journal_.emplace(out_.journal(), content);
    prior = find_prior(plan_, content, request_.out, mpi.cores());
  }
  plan_dispatch(prior.done);
  std::vector<std::uint32_t> already_done;
  for (const CellReport& r : prior.done) already_done.push_back(r.id);
  DispatchResult result = dispatch(mpi, plan_.jobs, already_done, process, schedule_options(request_, summary_), *this);
  summary_.cells_taken_over = prior.done.size();
  summary_.cells_planned = plan_.jobs.size();
  summary_.is_drained = is_drain_asked() && result.counts.abandoned != 0;
  summary_.lost_ranks = result.lost_ranks.size();
  summary_.peak_process_bytes = std::max(result.peak_bytes, peak_bytes_here());
  std::move(prior.done.begin(), prior.done.end(), std::back_inserter(result.reports));
  add_times(result.reports, summary_);  // what was taken over took no time
  for (const CellReport& r : result.reports)
    if (r.outcome == CellOutcome::baked) add_levels(r.levels, summary_.levels);
  summary_.scene = merge(plan_, result.reports, sources_.origin, request_.parameters);
  publish();
}

void MasterBake::plan_dispatch(const std::vector<CellReport>& done) {
  for (const SceneLoss& l : plan_.losses) feed_.record().lost(l.name, l.reason);
  feed_.record().planned(plan_.jobs, costs_of(plan_), unix_now_s());
  for (const CellReport& r : done) feed_.record().already_done(r.id);
  if (!done.empty())
    progress_.noted(std::to_string(done.size()) + " of " + std::to_string(plan_.jobs.size()) +
                    " cells are there already");
  feed_.publish();
}

/// A journal that cannot be written costs the next bake time: it looks into the shards instead.
void MasterBake::write_down(const CellReport& report) {
  try {
    journal_->append(plan_.jobs[report.id], report);
  } catch (const InputError& e) {
    progress_.noted(std::string("the bake goes on without its journal: ") + e.what());
  }
}

bool MasterBake::turn() {
  if (is_drain_asked() && feed_.record().state() == BakeState::baking) {
    feed_.record().enter(BakeState::draining);
    progress_.noted("asked to end: the cells in hand are finished, no new ones begun; Ctrl-C once more stops at once");
  }
  feed_.turn();
  return !is_drain_asked();
}

void MasterBake::joined(int rank, const std::string& host) { feed_.record().worker_joined(rank, host, unix_now_s()); }

void MasterBake::handed_out(std::uint32_t job, int rank) { feed_.record().handed_out(job, rank, unix_now_s()); }

bool MasterBake::finished(const CellReport& report) {
  write_down(report);
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
  feed_.record().process_died(rank, unix_now_s());
  progress_.noted("the bake process of rank " + std::to_string(rank) + " is started again: " + why);
}

void MasterBake::lost(int rank) {
  feed_.record().worker_lost(rank, unix_now_s());
  progress_.noted("nothing heard of rank " + std::to_string(rank) + "; its cells are baked elsewhere");
}

/// The scene is published: what the journal still says of removed shards harms nobody.
void MasterBake::forget_orphans() {
  try {
    journal_->keep_only(plan_.jobs);
  } catch (const InputError& e) {
    progress_.noted(std::string("the journal keeps what was pruned: ") + e.what());
  }
}

void MasterBake::publish() {
  feed_.record().enter(BakeState::publishing);
  feed_.publish();
  out_.expect_shards(summary_.scene);
  if (summary_.is_drained && out_.has_whole_scene()) return;  // until this one is whole, too
  refuse(request_, summary_.scene.losses, summary_.scene.cells.empty() && !summary_.is_drained);
  if (!summary_.scene.cells.empty()) out_.publish(summary_.scene);
  if (request_.prune && summary_.scene.losses.empty()) {
    summary_.pruned = out_.remove_orphans(summary_.scene);
    forget_orphans();
  }
  summary_.orphans = out_.orphans(summary_.scene);
}

}  // namespace gigabake
