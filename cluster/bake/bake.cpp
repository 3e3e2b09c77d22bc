#include "cluster/bake/bake.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <variant>

#include "cluster/bake/bake_session.h"
#include "cluster/bake/master_bake.h"
#include "cluster/bake/scan_tiles.h"
#include "cluster/dispatch/dispatch.h"
#include "cluster/launch/agreed_request.h"
#include "cluster/launch/rank_setup.h"
#include "cluster/process/drain.h"
#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/base/pluralize.h"
#include "format/system/message.h"
#include "format/system/meters/energy_meter.h"
#include "scheduler/journal/scan_cache.h"

namespace gigabake {
namespace {

using Clock = std::chrono::steady_clock;

/// The timeout of collective calls in heartbeat timeouts. A rank may work for longer than one heartbeat timeout while
/// the other ranks wait, for example on a plan of a million cells.
constexpr double heartbeat_timeouts_per_collective = 10;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Returns the change of OUT/edits.json. Without a requested change, both texts are those in OUT.
EditsChange edits_change(const BakeRequest& request) {
  if (request.edits) return *request.edits;
  const std::string text = request.out.empty() ? std::string() : read_edits_file(request.out);
  return {text, text};
}

void open_source(BakeSession& s) {
  set_memory_limit(s.request.memory_bytes);
  SourceOptions options = s.request.source_options;
  check_options_collectively(s.mpi, [&] {
    if (s.mpi.rank() != 0) return;  // only rank 0 opens the source
    s.edits = edits_change(s.request);
    const SceneEditList edits = edits_of_file(s.request.out, s.edits.after);
    options.edits = std::make_shared<const EditList>(voxel_edits(edits));
    options.source_edits = std::make_shared<const NamedSourceEdits>(source_edits(edits));
  });
  s.sources = open_shared_sources(s.mpi, s.request.source, options, s.request.parameters, s.progress.steps);
  s.request.parameters = s.sources.parameters;
  if (s.mpi.rank() == 0) s.report(SourceOpened{s.sources.scene});
}

/// Creates and locks OUT on rank 0; checks on every rank that OUT is visible.
void claim_output(BakeSession& s) {
  collective_try(s.mpi, [&] {
    if (s.mpi.rank() != 0) return;
    s.out.emplace(s.request.out, s.request.source);
    if (read_edits_file(s.request.out) != s.edits.before)
      throw InputError(edits_file_of(s.request.out), "",
                       "was changed by another process while this one started; run the same command again");
  });
  collective_try(s.mpi, [&] { expect_output_folder(s.request.out); });
}

void prepare_scratch(BakeSession& s) {
  collective_try(s.mpi, [&] {
    if (s.mpi.rank() != 0) return;
    const ScratchNeed need = scratch_need(s.sources.scene, memory_of(s.mpi, s.request));
    if (const auto line = scratch_info(need, scratch_of(s.request))) s.report(InfoLine{*line});
  });
  s.scratch.emplace(scratch_of(s.request));
}

void start_process(BakeSession& s, std::unique_ptr<ChildProcess> early) {
  s.process.emplace(setup_of(s.mpi, s.request, s.sources), process_options(s.request), std::move(early));
  collective_try(s.mpi, [&] { s.process->prepare(); });
}

/// The scan results that rank 0 has cached, and the tiles that must be scanned.
struct KnownScans {
  std::vector<TileScan> scans;
  std::vector<std::uint32_t> missing;
};

/// Finds the scan results that are cached in `folder`, the OUT of an earlier bake. `folder` may be empty.
KnownScans known_scans(const std::filesystem::path& folder, const SceneSources& sources,
                       const BakeParameters& parameters, int threads, const Progress& progress) {
  progress.step("finding tiles whose scans are cached");
  KnownScans known;
  std::vector<std::optional<TileScan>> cached(sources.tiles.size());
  if (!folder.empty()) cached = ScanCache(scan_cache_of(folder)).find_all(sources, parameters, threads, progress);
  for (std::uint32_t tile = 0; tile < cached.size(); ++tile) {
    if (cached[tile])
      known.scans.push_back(std::move(*cached[tile]));
    else
      known.missing.push_back(tile);
  }
  return known;
}

std::string no_triangles(const BakePlan& plan) {
  std::string line = "holds no triangles to bake";
  if (plan.skipped_points + plan.skipped_lines != 0)
    line += "; skipped " + pluralize(plan.skipped_points, "point") + " and " + pluralize(plan.skipped_lines, "line") +
            ", which have no surface";
  if (plan.non_finite + plan.zero_area != 0)
    line += "; dropped " + pluralize(plan.non_finite, "triangle that is", "triangles that are") + " not finite and " +
            std::to_string(plan.zero_area) + " without area";
  return line;
}

/// Saves the scan results in OUT. If the cache cannot be written, the next bake scans all tiles again; this bake
/// continues.
void keep_scans(const BakeSession& s) {
  if (!s.out) return;
  try {
    save_scan_cache(scan_cache_of(s.request.out), s.sources.scene, s.request.parameters, s.scans);
  } catch (const InputError& e) {
    s.report(WarningLine{std::string("the next bake scans all tiles again: ") + e.what()});
  }
}

bool is_stop_asked(const Progress& steps) {
  try {
    steps.advance(0);
    return false;
  } catch (const Stopped&) {
    return true;
  }
}

/// Scans the tiles whose results are not cached. If the bake is stopped, OUT keeps the results obtained until then.
/// Errors  Stopped.
void scan_source(BakeSession& s) {
  KnownScans known;
  collective_try(s.mpi, [&] {
    if (s.mpi.rank() == 0)
      known = known_scans(s.request.out, s.sources.scene, s.request.parameters, s.mpi.cores(), s.progress.steps);
  });
  bool is_stopped = false;
  const auto scanned = [&](std::size_t done) {
    s.report(TilesScanned{known.scans.size() + done, s.sources.scene.tiles.size()});
    s.report(BakeAlive{});
    is_stopped = is_stop_asked(s.progress.steps);
    return !is_stopped;
  };
  const auto died = [&](int rank, const std::string& why) { s.report(ProcessDied{rank, why}); };
  s.scans = scan_tiles(s.mpi, known.missing, *s.process, s.request.timeouts.heartbeat_timeout_s, {scanned, died});
  std::move(known.scans.begin(), known.scans.end(), std::back_inserter(s.scans));
  if (is_stopped) keep_scans(s);
  fail_collectively(s.mpi, {}, is_stopped);
}

/// Makes the plan on rank 0. Throws on every rank if the losses of the plan prevent a scene.
void plan_jobs(BakeSession& s, PlanLevels levels) {
  check_options_collectively(s.mpi, [&] {
    if (s.mpi.rank() != 0) return;
    s.plan = make_plan(s.scans, s.sources.scene, s.request.parameters, levels, s.progress.steps);
    if (s.plan.jobs.empty() && s.plan.losses.empty()) throw InputError(s.request.source, "", no_triangles(s.plan));
    s.report(JobsPlanned{s.plan});
  });
  collective_try(s.mpi, [&] { refuse(s.request, s.plan.losses, s.mpi.rank() == 0 && s.plan.jobs.empty()); });
  keep_scans(s);
  s.scans.clear();
  s.summary.precision = s.plan.precision;
  s.summary.warnings = s.plan.warnings;
  s.summary.scan_s = seconds_since(s.start);
}

/// Throws on every rank if a rank has reported that it has no device, although one was requested. Other ranks report
/// their devices while cells are dispatched, so that no rank waits for the driver of another.
void expect_device(const BakeSession& s) {
  collective_try(s.mpi, [&] {
    const auto& device = s.process->device();
    if (device && !device->error.empty()) throw std::runtime_error(device->error);
  });
}

/// Warns if the ranks may use at most half of the host's cores. The cause may be that mpirun binds each rank to one
/// core by default if there are few ranks.
void warn_of_binding(const MpiSession& mpi, const BakeRequest& request) {
  if (mpi.rank() != 0 || mpi.ranks() == 1 || request.threads > 0 || mpi.cores() * mpi.ranks() * 2 > mpi.host_cores())
    return;
  print_message("each rank may use {} of this host's {} cores; mpirun --bind-to none lets them share all\n",
                mpi.cores(), mpi.host_cores());
}

/// Bakes the plan's cells and overviews on all ranks and publishes the scene on rank 0.
void bake_jobs(BakeSession& s) {
  const auto planned = Clock::now();
  if (s.mpi.rank() != 0) work(s.mpi, *s.process, s.request.timeouts.heartbeat_timeout_s);
  std::optional<std::string> failure;
  try {
    if (s.mpi.rank() == 0) MasterBake(s).run();
  } catch (const std::exception& e) {
    failure = reason_of(e);
  }
  // A lost rank would never take part in a collective call; the caller ends the other ranks.
  const bool has_lost = s.summary.lost_ranks != 0;
  if (failure && has_lost) throw std::runtime_error(*failure);
  if (!has_lost) fail_collectively(s.mpi, failure);
  if (!has_lost && s.mpi.sum_of(s.summary.is_drained ? 1 : 0) == 0) s.scratch->is_not_needed();
  s.summary.bake_s = seconds_since(planned);
}

/// Runs all steps of a bake. OUT is unlocked when it returns. `feed` is null except on rank 0.
BakeSummary run_steps(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress, StatusFeed* feed,
                      std::unique_ptr<ChildProcess> early) {
  EnergyMeter energy;
  BakeSession s(mpi, request, progress, feed);
  s.summary.ranks = mpi.ranks();
  s.summary.threads = threads_of(mpi, request);
  warn_of_binding(mpi, request);
  open_source(s);
  claim_output(s);
  prepare_scratch(s);
  start_process(s, std::move(early));
  scan_source(s);
  expect_device(s);
  plan_jobs(s, request.overviews ? PlanLevels::cells_and_overviews : PlanLevels::cells);
  bake_jobs(s);
  s.summary.joules = energy.joules();
  return std::move(s.summary);
}

/// Publishes the final status on rank 0.
void end_status(StatusFeed& feed, BakeSummary& summary) {
  const bool is_whole = summary.scene.losses.empty();
  const BakeState published = is_whole ? BakeState::complete : BakeState::incomplete;
  feed.take(StateEntered{summary.is_drained ? BakeState::drained : published});
  summary.status = feed.record().at(unix_now_s());
}

/// Returns a listener that also publishes the status of the scan. plan_bake() needs it because a plan has no
/// StatusFeed.
BakeListener with_scan_status(BakeListener listener) {
  return [listener = std::move(listener), record = std::optional<BakeStatusRecord>()](const BakeEvent& event) mutable {
    listener(event);
    const double now_s = unix_now_s();
    if (std::holds_alternative<SourceOpened>(event)) record.emplace(BakeIdentity{}, now_s);
    if (!record || !std::holds_alternative<TilesScanned>(event)) return;
    record->add(event, now_s);
    listener(StatusUpdated{record->at(now_s)});
  };
}

}  // namespace

PlannedBake plan_bake(MpiSession& mpi, const BakeRequest& own, const BakeProgress& progress) {
  const BakeRequest request = agreed_request(mpi, own);
  BakeProgress own_progress = progress;
  if (progress.listener) own_progress.listener = with_scan_status(progress.listener);
  BakeSession s(mpi, request, own_progress);
  open_source(s);
  BakeRequest on_cpu = request;
  on_cpu.backend = Backend::cpu;  // a scan needs no device
  WorkerSetup setup = setup_of(mpi, on_cpu, s.sources);
  setup.worker.scratch.clear();  // a plan leaves no files, so large tiles are scanned part by part
  s.process.emplace(std::move(setup), process_options(request));
  scan_source(s);
  plan_jobs(s, PlanLevels::cells);
  return {std::move(s.plan), std::move(s.sources), s.summary.scan_s};
}

BakeSummary bake(MpiSession& mpi, const BakeRequest& own, const BakeProgress& progress,
                 std::unique_ptr<ChildProcess> early) {
  const BakeRequest request = agreed_request(mpi, own);
  mpi.set_collective_timeout(heartbeat_timeouts_per_collective * request.timeouts.heartbeat_timeout_s);
  std::optional<StatusFeed> feed;
  if (mpi.rank() == 0) feed.emplace(request.out, mpi.ranks(), request.metrics, progress.listener);
  try {
    BakeSummary summary = run_steps(mpi, request, progress, feed ? &*feed : nullptr, std::move(early));
    if (feed) end_status(*feed, summary);
    return summary;
  } catch (const Stopped&) {
    if (feed) feed->stop();
    throw;
  } catch (const RankLost&) {
    throw;  // only the launch ends: the next launch resumes the bake, and the status shows an interruption
  } catch (const std::exception& e) {
    if (feed) feed->fail(reason_of(e));
    throw;
  }
}

}  // namespace gigabake
