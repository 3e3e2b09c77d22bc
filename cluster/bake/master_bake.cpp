#include "cluster/bake/master_bake.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <sys/resource.h>

#include "cluster/bake/empty_scene.h"
#include "cluster/bake/tile_loss.h"
#include "cluster/dispatch/dispatch.h"
#include "cluster/launch/local_ranks.h"
#include "cluster/launch/rank_setup.h"
#include "cluster/mpi/mpi_rank_link.h"
#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "core/base/quote.h"
#include "format/system/publish.h"
#include "scheduler/journal/cached_results.h"
#include "scheduler/plan/merge.h"
#include "worker/device/backend.h"
#include "worker/pipeline/writer_pool_size.h"

namespace gigabake {
namespace {

/// Returns whether this host has GPUs that the bake may use. A rank reports its device only during the dispatch, when
/// the driver has started.
bool expects_device(const BakeRequest& request) {
  return request.backend != Backend::cpu && is_built_for_devices() && visible_gpus(environment_of_process) > 0;
}

DispatchOptions dispatch_options(const MpiSession& mpi, const BakeRequest& request) {
  WorkerOptions worker;
  worker.threads = threads_of(mpi, request);
  worker.memory_bytes = memory_of(mpi, request);
  DispatchOptions options;
  options.slots =
      slots_of_worker(expects_device(request), int(concurrent_cells_for(worker)), writer_pool_size_for(worker).writers);
  options.keep_going = request.keep_going;
  options.heartbeat_timeout_s = request.timeouts.heartbeat_timeout_s;
  return options;
}

std::uint64_t peak_bytes_here() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::uint64_t(usage.ru_maxrss) * 1024;
}

void add_times(const std::vector<CellReport>& reports, const BakePlan& plan, BakeSummary& summary) {
  for (const CellReport& r : reports) {
    summary.read_s += r.read_s;
    summary.kernel_s += r.kernel_s;
    summary.write_s += r.write_s;
    summary.peak_kernel_bytes = std::max(summary.peak_kernel_bytes, r.peak_bytes);
    summary.cells_empty += r.outcome == CellOutcome::empty && r.id < plan.cells();
    summary.cells_on_device += r.on_device;
    summary.bad_uv += r.bad_uv;
  }
}

}  // namespace

void refuse(const BakeRequest& request, const std::vector<SceneLoss>& losses, bool nothing_baked) {
  if (losses.empty() || (request.keep_going && !nothing_baked)) return;
  const std::size_t more = losses.size() - 1;
  const bool is_named = !reason_without_tile(losses[0]).empty();
  throw InputError(is_named ? std::filesystem::path() : request.source, "",
                   std::string(nothing_baked ? "nothing could be baked" : "stopped (`no_keep_going`)") +
                       (more == 0 ? "" : " (" + pluralize(losses.size(), "loss", "losses") + ")") + ": " +
                       (is_named ? "" : short_path(losses[0].name) + ": ") + losses[0].reason);
}

MasterBake::MasterBake(BakeSession& session)
    : session_(session),
      request_(session.request),
      plan_(session.plan),
      out_(*session.out),
      summary_(session.summary) {}

void MasterBake::run() {
  CachedResults prior;
  {
    const JournalContent content = read_journal(out_.journal());
    journal_.emplace(out_.journal(), content);
    prior = find_cached(plan_, content, request_.out, session_.mpi.cores());
  }
  plan_file_.emplace(session_);
  report_reused(prior.done);
  MpiRankLink link(session_.mpi, *session_.process);
  DispatchResult result = dispatch(link, plan_.jobs, prior.done, dispatch_options(session_.mpi, request_),
                                   [this](const BakeEvent& event) { take(event); });
  summary_.cells_taken_over = cells_among(prior.done);
  summary_.cells_planned = plan_.cells();
  summary_.is_drained = result.is_drained;
  summary_.ranks_with_device = result.ranks_with_device;
  summary_.no_device = result.no_device;
  summary_.lost_ranks = result.lost_ranks.size();
  summary_.peak_process_bytes = std::max({result.peak_bytes, session_.process->peak_bytes(), peak_bytes_here()});
  summary_.amounts = amounts_of(plan_, result.reports, request_.parameters.voxel_size_m);
  summary_.work = result.work;
  summary_.work.cpu_s += process_cpu_s();
  std::move(prior.done.begin(), prior.done.end(), std::back_inserter(result.reports));
  add_times(result.reports, plan_, summary_);  // find_cached() sets the times of reused cells to 0
  for (const CellReport& r : result.reports)
    if (r.outcome == CellOutcome::baked) add_levels(r.levels, r.cell.first_lod, r.cell.copied_lods, summary_.levels);
  summary_.scene = merge(plan_, result.reports, session_.sources.scene.origin, request_.parameters);
  publish();
}

void MasterBake::report_reused(const std::vector<CellReport>& done) const {
  if (const std::size_t cells = cells_among(done); cells != 0)
    session_.report(InfoLine{std::to_string(cells) + " of " + pluralize(plan_.cells(), "cell") +
                             (cells == 1 ? " is" : " are") + " complete already"});
  session_.report(DispatchBegan{plan_, done});
}

/// Appends a finished job to the journal first, then passes the event on. If the journal cannot be written, this bake
/// continues. The next bake then takes longer, because it reads the shards instead of the journal.
void MasterBake::take(const BakeEvent& event) {
  if (const auto* finished = std::get_if<JobFinished>(&event)) {
    try {
      journal_->append(finished->order, finished->report);
    } catch (const InputError& e) {
      session_.report(WarningLine{std::string("the bake continues without its journal: ") + e.what()});
    }
  }
  plan_file_->take(event);
  session_.report(event);
}

std::size_t MasterBake::cells_among(const std::vector<CellReport>& reports) const {
  return std::size_t(
      std::count_if(reports.begin(), reports.end(), [this](const CellReport& r) { return r.id < plan_.cells(); }));
}

/// Drops removed shards from the journal. A failure is harmless because the scene is already published.
void MasterBake::forget_orphans() {
  try {
    journal_->keep_only(plan_.jobs);
  } catch (const InputError& e) {
    session_.report(WarningLine{std::string("the journal still lists pruned shards: ") + e.what()});
  }
}

/// Publishes the scene, and before it the edits and the source that it was baked from. If the scene cannot be
/// published, the edits are restored.
void MasterBake::publish_scene() {
  const EditsChange& edits = session_.edits;
  if (!request_.source_record.empty()) publish_file(source_file_of(request_.out), request_.source_record);
  if (edits.after == edits.before) return out_.publish(summary_.scene);
  write_edits_file(request_.out, edits.after);
  try {
    out_.publish(summary_.scene);
  } catch (...) {
    write_edits_file(request_.out, edits.before);
    throw;
  }
}

void MasterBake::publish() {
  session_.report(StateEntered{BakeState::publishing});
  out_.expect_shards(summary_.scene);
  if (summary_.is_drained && out_.has_whole_scene()) return;  // keep the complete scene until the new one is complete
  refuse(request_, summary_.scene.losses, summary_.scene.cells.empty() && !summary_.is_drained);
  const bool is_empty = summary_.scene.cells.empty();
  if (is_empty && summary_.scene.losses.empty())
    throw nothing_visible(request_.source, session_.sources.scene, plan_, "nothing was published");
  if (!is_empty) publish_scene();  // an empty scene was drained before its first voxel
  if (request_.prune && summary_.scene.losses.empty()) {
    summary_.pruned = out_.remove_orphans(summary_.scene);
    forget_orphans();
  }
  summary_.orphans = out_.orphans(summary_.scene);
}

}  // namespace gigabake
