#include "cluster/bake.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <sys/resource.h>

#include "cluster/dispatch.h"
#include "cluster/output_folder.h"
#include "cluster/survey.h"
#include "format/error.h"
#include "scheduler/merge.h"

namespace gigabake {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

int threads_of(const MpiSession& mpi, const BakeRequest& request) {
  return request.threads > 0 ? request.threads : mpi.cores();
}

std::int64_t peak_process_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t(usage.ru_maxrss) * 1024;
}

SceneSources open_together(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress) {
  SceneSources sources;
  all_or_none(mpi, [&] { sources = open_sources(request.source, request.source_options); });
  if (mpi.rank() == 0) progress.opened(sources);
  return sources;
}

BakePlan survey_and_plan(MpiSession& mpi, const BakeRequest& request, const SceneSources& sources,
                         const BakeProgress& progress) {
  std::vector<TileSurvey> surveys =
      survey_tiles(mpi, sources, request.parameters, threads_of(mpi, request),
                   [&](std::size_t done) { progress.surveyed(done, sources.tiles.size()); });
  BakePlan plan;
  all_or_none(mpi, [&] {
    if (mpi.rank() != 0) return;
    plan = make_plan(std::move(surveys), sources, request.parameters);
    if (plan.jobs.empty() && plan.losses.empty()) throw InputError(request.source, "", "holds no triangles to bake");
    progress.planned(plan);
  });
  return plan;
}

/// Losses that leave the previous scene in place.
void refuse(const BakeRequest& request, const std::vector<SceneLoss>& losses, bool nothing_baked) {
  if (losses.empty() || (request.keep_going && !nothing_baked)) return;
  const std::size_t more = losses.size() - 1;
  throw InputError(request.source, "",
                   std::string(nothing_baked ? "nothing could be baked" : "stopped (--no-keep-going)") + ": " +
                       losses[0].name + ": " + losses[0].reason +
                       (more == 0 ? "" : " (and " + std::to_string(more) + " more losses)"));
}

/// A rank without a device beside others that have one says so: its cells take longer.
DeviceChoice choose_device_together(MpiSession& mpi, const BakeRequest& request, BakeSummary& summary) {
  DeviceChoice choice;
  all_or_none(mpi, [&] { choice = choose_device(request.backend, request.gpus, mpi.rank_on_host()); });
  summary.ranks_with_device = int(mpi.sum_of(choice.device.has_value() ? 1 : 0));
  summary.no_device = choice.reason;
  if (summary.ranks_with_device != 0 && !choice.device && !choice.reason.empty())
    std::fprintf(stderr, "rank %d on %s uses the CPU: %s\n", mpi.rank(), host_name().c_str(), choice.reason.c_str());
  return choice;
}

/// mpirun binds each of few ranks to one core unless told otherwise.
void warn_of_binding(const MpiSession& mpi, const BakeRequest& request) {
  if (mpi.rank() != 0 || mpi.ranks() == 1 || request.threads > 0 || mpi.cores() * mpi.ranks() * 2 > mpi.host_cores())
    return;
  std::fprintf(stderr, "each rank may use %d of this host's %d cores; mpirun --bind-to none lets them share all\n",
               mpi.cores(), mpi.host_cores());
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

void bake_as_master(MpiSession& mpi, const BakeRequest& request, const SceneSources& sources, const BakePlan& plan,
                    const OutputFolder& out, const MakePipeline& make_pipeline, const BakeProgress& progress,
                    BakeSummary& summary) {
  std::size_t done = 0;
  const auto on_report = [&](const CellReport& r) {
    progress.cell_done(r, plan.jobs[r.id], ++done, plan.jobs.size());
    return request.keep_going || r.outcome != CellOutcome::failed;
  };
  const std::vector<CellReport> reports = dispatch(mpi, plan.jobs, make_pipeline, on_report);
  summary.cells_planned = plan.jobs.size();
  add_times(reports, summary);
  summary.scene = merge(plan, reports, sources.origin, request.parameters);
  out.expect_shards(summary.scene);
  refuse(request, summary.scene.losses, summary.scene.cells.empty());
  out.publish(summary.scene);
  if (request.prune) summary.pruned = out.remove_orphans(summary.scene);
  summary.orphans = out.orphans(summary.scene);
}

}  // namespace

BakePlan plan_bake(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress) {
  return survey_and_plan(mpi, request, open_together(mpi, request, progress), progress);
}

BakeSummary bake(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress) {
  const auto start = Clock::now();
  BakeSummary summary;
  summary.ranks = mpi.ranks();
  summary.threads = threads_of(mpi, request);
  const DeviceChoice device = choose_device_together(mpi, request, summary);
  warn_of_binding(mpi, request);
  const SceneSources sources = open_together(mpi, request, progress);
  std::optional<OutputFolder> out;
  all_or_none(mpi, [&] {
    if (mpi.rank() == 0) out.emplace(request.out, request.source);
  });
  all_or_none(mpi, [&] { expect_output_folder(request.out); });
  const BakePlan plan = survey_and_plan(mpi, request, sources, progress);
  all_or_none(mpi, [&] { refuse(request, plan.losses, mpi.rank() == 0 && plan.jobs.empty()); });
  summary.survey_s = seconds_since(start);
  const auto planned = Clock::now();
  const MakePipeline make_pipeline = [&] {
    return std::make_unique<CellPipeline>(
        sources, request.parameters, WorkerOptions{summary.threads, request.memory_bytes, request.out, device.device});
  };
  if (mpi.rank() != 0) work(mpi, make_pipeline);
  all_or_none(mpi, [&] {
    if (mpi.rank() == 0) bake_as_master(mpi, request, sources, plan, *out, make_pipeline, progress, summary);
  });
  summary.bake_s = seconds_since(planned);
  summary.peak_process_bytes = std::uint64_t(mpi.max_of(peak_process_bytes()));
  return summary;
}

}  // namespace gigabake
