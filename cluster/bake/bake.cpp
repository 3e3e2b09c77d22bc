#include "cluster/bake/bake.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <variant>

#include "cluster/bake/bake_scratch.h"
#include "cluster/bake/dispatch.h"
#include "cluster/bake/dispatch_log.h"
#include "cluster/bake/master_bake.h"
#include "cluster/bake/scan_tiles.h"
#include "cluster/launch/agreed_request.h"
#include "cluster/launch/rank_setup.h"
#include "cluster/process/drain.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "format/system/message.h"
#include "scheduler/journal/scan_cache.h"
#include "scheduler/plan/overviews.h"

namespace gigabake {
namespace {

using Clock = std::chrono::steady_clock;

/// Factor from the heartbeat timeout to the timeout of collective calls. One rank may work for longer than a heartbeat
/// interval while the others wait, for example on a plan of a million cells.
constexpr double heartbeat_timeouts_per_collective = 10;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

SharedSources open_together(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress) {
  set_memory_limit(request.memory_bytes);
  SharedSources sources = open_shared_sources(mpi, request.source, request.source_options, progress.steps);
  if (mpi.rank() == 0) progress.opened(sources.scene);
  return sources;
}

/// The scan results that rank 0 has cached, and the tiles that must be scanned.
struct KnownScans {
  std::vector<TileScan> scans;
  std::vector<std::uint32_t> missing;
};

/// Finds cached scan results. folder: OUT of an earlier bake; may be empty.
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
    line += "; skipped " + counted(plan.skipped_points, "point") + " and " + counted(plan.skipped_lines, "line") +
            ", which have no surface";
  if (plan.non_finite + plan.zero_area != 0)
    line += "; dropped " + counted(plan.non_finite, "triangle that is", "triangles that are") + " not finite and " +
            std::to_string(plan.zero_area) + " without area";
  return line;
}

/// Saves the scan results. If the cache cannot be written, the next bake scans all tiles again; this bake continues.
void keep_scans(const BakeRequest& request, const SceneSources& sources, const std::vector<TileScan>& scans,
                const BakeProgress& progress) {
  try {
    save_scan_cache(scan_cache_of(request.out), sources, request.parameters, scans);
  } catch (const InputError& e) {
    progress.warning(std::string("the next bake scans all tiles again: ") + e.what());
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

/// Policy for the scan results of a stopped bake: discard them or keep them for the next bake.
enum class StoppedScan { forget, keep };

/// Returns the scan results of all tiles on rank 0. on_scan: called on rank 0 with the number of results.
/// Errors  Stopped.
std::vector<TileScan> scan(MpiSession& mpi, const BakeRequest& request, const SceneSources& sources,
                           BakeProcess& process, const BakeProgress& progress, StoppedScan when_stopped,
                           const std::function<void(std::size_t)>& on_scan,
                           const std::function<void(int rank)>& on_death) {
  KnownScans known;
  collective_try(mpi, [&] {
    if (mpi.rank() == 0) known = known_scans(request.out, sources, request.parameters, mpi.cores(), progress.steps);
  });
  bool is_stopped = false;
  std::vector<TileScan> scans = scan_tiles(mpi, known.missing, process, request.timeouts.heartbeat_timeout_s,
                                           {[&](std::size_t done) {
                                              on_scan(known.scans.size() + done);
                                              is_stopped = is_stop_asked(progress.steps);
                                              return !is_stopped;
                                            },
                                            [&](int rank, const std::string& why) {
                                              on_death(rank);
                                              progress.warning(restart_line(rank, why));
                                            }});
  std::move(known.scans.begin(), known.scans.end(), std::back_inserter(scans));
  if (is_stopped && when_stopped == StoppedScan::keep) keep_scans(request, sources, scans, progress);
  fail_collectively(mpi, {}, is_stopped);
  return scans;
}

/// Collective call. Returns the plan on rank 0.
BakePlan plan_from(MpiSession& mpi, const BakeRequest& request, const SceneSources& sources,
                   std::vector<TileScan> scans, const BakeProgress& progress) {
  BakePlan plan;
  collective_try(mpi, [&] {
    if (mpi.rank() != 0) return;
    plan = make_plan(std::move(scans), sources, request.parameters, progress.steps);
    if (plan.jobs.empty() && plan.losses.empty()) throw InputError(request.source, "", no_triangles(plan));
    progress.planned(plan);
  });
  return plan;
}

/// Waits until the process has reported its device. Restarts a process that dies before that; gives up after the third
/// consecutive death.
DeviceChoice device_of(const MpiSession& mpi, BakeProcess& process) {
  constexpr std::chrono::milliseconds max_wait{50};
  for (int deaths = 0; !process.device(); process.wait(max_wait)) {
    process.prepare();
    const auto event = process.poll();
    const auto* died = event ? std::get_if<BakeProcess::Died>(&*event) : nullptr;
    if (died == nullptr) continue;
    if (++deaths == max_failed_starts) throw_no_start(died->why);
    print_message("rank {} on {}: the bake process ended during its start, and is started again: {}\n", mpi.rank(),
                  host_name(), died->why);
  }
  if (!process.device()->error.empty()) throw std::runtime_error(process.device()->error);
  return process.device()->choice;
}

/// Chooses devices. A rank without a device prints a line if other ranks have one, because its cells take longer.
void choose_devices(MpiSession& mpi, BakeProcess& process, BakeSummary& summary) {
  DeviceChoice choice;
  collective_try(mpi, [&] { choice = device_of(mpi, process); });
  summary.ranks_with_device = int(mpi.sum_of(choice.device.has_value() ? 1 : 0));
  summary.no_device = choice.reason;
  if (summary.ranks_with_device != 0 && !choice.device && !choice.reason.empty())
    print_message("rank {} on {} uses the CPU: {}\n", mpi.rank(), host_name(), choice.reason);
}

/// Warns if the ranks may use less than half of the cores. The reason is that mpirun binds each rank to one core by
/// default if there are few ranks.
void warn_of_binding(const MpiSession& mpi, const BakeRequest& request) {
  if (mpi.rank() != 0 || mpi.ranks() == 1 || request.threads > 0 || mpi.cores() * mpi.ranks() * 2 > mpi.host_cores())
    return;
  print_message("each rank may use {} of this host's {} cores; mpirun --bind-to none lets them share all\n",
                mpi.cores(), mpi.host_cores());
}

/// Bakes and records the status. feed: set on rank 0 only.
BakeSummary bake_watched(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress,
                         std::optional<StatusFeed>& feed) {
  const auto start = Clock::now();
  BakeSummary summary;
  summary.ranks = mpi.ranks();
  summary.threads = threads_of(mpi, request);
  warn_of_binding(mpi, request);
  const SharedSources shared = open_together(mpi, request, progress);
  const SceneSources& sources = shared.scene;
  std::optional<OutputFolder> out;
  collective_try(mpi, [&] {
    if (mpi.rank() == 0) out.emplace(request.out, request.source);
  });
  collective_try(mpi, [&] { expect_output_folder(request.out); });
  collective_try(mpi, [&] {
    if (mpi.rank() != 0) return;
    const ScratchNeed need = scratch_need(sources, memory_of(mpi, request));
    if (const auto note = scratch_info(need, scratch_of(request))) progress.info(*note);
  });
  BakeScratch scratch(scratch_of(request));
  BakeProcess process(setup_of(mpi, request, shared), process_options(request));
  collective_try(mpi, [&] { process.prepare(); });
  std::vector<TileScan> scans = scan(
      mpi, request, sources, process, progress, StoppedScan::keep,
      [&](std::size_t done) {
        feed->record().scanned(done, sources.tiles.size());
        feed->turn();
      },
      [&](int rank) { feed->record().process_died(rank, unix_now_s()); });
  choose_devices(mpi, process, summary);  // after the scan, which the driver's start would delay
  BakePlan plan = plan_from(mpi, request, sources, scans, progress);
  collective_try(mpi, [&] { refuse(request, plan.losses, mpi.rank() == 0 && plan.jobs.empty()); });
  if (mpi.rank() == 0) keep_scans(request, sources, scans, progress);
  scans.clear();
  if (request.overviews) add_overviews(plan.jobs);
  summary.precision = plan.precision;
  summary.warnings = plan.warnings;
  summary.scan_s = seconds_since(start);
  const auto planned = Clock::now();
  if (mpi.rank() != 0) work(mpi, process, request.timeouts.heartbeat_timeout_s);
  std::optional<std::string> failure;
  try {
    if (mpi.rank() == 0) MasterBake(request, sources, plan, *out, progress, *feed, summary).run(mpi, process);
  } catch (const std::exception& e) {
    failure = reason_of(e);
  }
  // A lost rank would never take part in a collective call; the caller ends the other ranks.
  if (failure && summary.lost_ranks != 0) throw std::runtime_error(*failure);
  if (summary.lost_ranks == 0) fail_collectively(mpi, failure);
  if (summary.lost_ranks == 0 && mpi.sum_of(summary.is_drained ? 1 : 0) == 0) scratch.is_not_needed();
  summary.bake_s = seconds_since(planned);
  return summary;
}

/// Publishes the final status on rank 0.
void end_status(StatusFeed& feed, BakeSummary& summary) {
  const bool is_whole = summary.scene.losses.empty();
  feed.record().enter(summary.is_drained ? BakeState::drained : is_whole ? BakeState::complete : BakeState::incomplete);
  feed.publish();
  summary.status = feed.record().at(unix_now_s());
}

}  // namespace

PlannedBake plan_bake(MpiSession& mpi, const BakeRequest& own, const BakeProgress& progress) {
  const auto start = Clock::now();
  const BakeRequest request = agreed_request(mpi, own);
  PlannedBake planned;
  planned.sources = open_together(mpi, request, progress);
  const SceneSources& sources = planned.sources.scene;
  BakeRequest on_cpu = request;
  on_cpu.backend = Backend::cpu;  // a scan needs no device
  WorkerSetup setup = setup_of(mpi, on_cpu, planned.sources);
  setup.worker.scratch.clear();  // a plan leaves no files: large tiles are scanned part by part
  BakeProcess process(std::move(setup), process_options(request));
  std::vector<TileScan> scans = scan(
      mpi, request, sources, process, progress, StoppedScan::forget,
      [&](std::size_t done) { progress.scanned(done, sources.tiles.size()); }, [](int) {});
  planned.plan = plan_from(mpi, request, sources, std::move(scans), progress);
  collective_try(mpi, [&] { refuse(request, planned.plan.losses, mpi.rank() == 0 && planned.plan.jobs.empty()); });
  planned.scan_s = seconds_since(start);
  return planned;
}

BakeSummary bake(MpiSession& mpi, const BakeRequest& own, const BakeProgress& progress) {
  const BakeRequest request = agreed_request(mpi, own);
  mpi.set_collective_timeout(heartbeat_timeouts_per_collective * request.timeouts.heartbeat_timeout_s);
  std::optional<StatusFeed> feed;
  if (mpi.rank() == 0) feed.emplace(request.out, mpi.ranks(), request.metrics, progress.status);
  try {
    BakeSummary summary = bake_watched(mpi, request, progress, feed);
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
