#include "cluster/bake.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <sys/resource.h>
#include <variant>

#include "cluster/dispatch.h"
#include "cluster/drain.h"
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

BakeProcessOptions process_options(const BakeRequest& request) {
  BakeProcessOptions options;
  options.stall_s = request.stall_s;
  options.cell_timeout_s = request.cell_timeout_s;
  return options;
}

ScheduleOptions schedule_options(const BakeRequest& request) {
  ScheduleOptions options;
  options.silence_s = request.silence_s;
  return options;
}

std::uint64_t peak_bytes_here() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::uint64_t(usage.ru_maxrss) * 1024;
}

SceneSources open_together(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress) {
  SceneSources sources;
  all_or_none(mpi, [&] { sources = open_sources(request.source, request.source_options); });
  if (mpi.rank() == 0) progress.opened(sources);
  return sources;
}

BakePlan survey_and_plan(MpiSession& mpi, const BakeRequest& request, const SceneSources& sources, BakeProcess& process,
                         const BakeProgress& progress) {
  std::vector<std::uint32_t> tiles(sources.tiles.size());
  std::iota(tiles.begin(), tiles.end(), 0u);
  std::vector<TileSurvey> surveys =
      survey_tiles(mpi, tiles, process, [&](std::size_t done) { progress.surveyed(done, sources.tiles.size()); });
  BakePlan plan;
  all_or_none(mpi, [&] {
    if (mpi.rank() != 0) return;
    plan = make_plan(std::move(surveys), sources, request.parameters);
    if (plan.jobs.empty() && plan.losses.empty()) throw InputError(request.source, "", "holds no triangles to bake");
    progress.planned(plan);
  });
  return plan;
}

WorkerSetup setup_of(const MpiSession& mpi, const BakeRequest& request, const SceneSources& sources) {
  WorkerSetup setup;
  setup.source = request.source;
  setup.source_options = request.source_options;
  setup.parameters = request.parameters;
  setup.worker = {threads_of(mpi, request), request.memory_bytes, request.out};
  setup.device = {request.backend, request.gpus, mpi.rank_on_host()};
  setup.tiles = std::uint32_t(sources.tiles.size());
  return setup;
}

/// Waits for the process to have its device.
DeviceChoice device_of(BakeProcess& process) {
  constexpr std::chrono::milliseconds longest_wait{50};
  for (process.prepare(); !process.device(); process.wait(longest_wait))
    if (const auto event = process.poll())
      if (const auto* died = std::get_if<BakeProcess::Died>(&*event))
        throw std::runtime_error("the process that bakes ended before it began: " + died->why);
  if (!process.device()->error.empty()) throw std::runtime_error(process.device()->error);
  return process.device()->choice;
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
void choose_devices(MpiSession& mpi, BakeProcess& process, BakeSummary& summary) {
  DeviceChoice choice;
  all_or_none(mpi, [&] { choice = device_of(process); });
  summary.ranks_with_device = int(mpi.sum_of(choice.device.has_value() ? 1 : 0));
  summary.no_device = choice.reason;
  if (summary.ranks_with_device != 0 && !choice.device && !choice.reason.empty())
    std::fprintf(stderr, "rank %d on %s uses the CPU: %s\n", mpi.rank(), host_name().c_str(), choice.reason.c_str());
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

/// What rank 0 does while cells are baked, and after.
class MasterBake {
 public:
  MasterBake(const BakeRequest& request, const SceneSources& sources, const BakePlan& plan, const OutputFolder& out,
             const BakeProgress& progress, BakeSummary& summary)
      : request_(request), sources_(sources), plan_(plan), out_(out), progress_(progress), summary_(summary) {}

  void run(MpiSession& mpi, BakeProcess& process) {
    DispatchResult result = dispatch(mpi, plan_.jobs, {}, process, schedule_options(request_), events());
    summary_.cells_planned = plan_.jobs.size();
    summary_.is_drained = result.is_drained && result.counts.abandoned != 0;
    summary_.lost_ranks = result.lost_ranks.size();
    summary_.peak_process_bytes = std::max(result.peak_bytes, peak_bytes_here());
    add_times(result.reports, summary_);
    summary_.scene = merge(plan_, result.reports, sources_.origin, request_.parameters);
    publish();
  }

 private:
  DispatchEvents events() {
    DispatchEvents e;
    e.on_report = [this](const CellReport& r, int) {
      progress_.cell_done(r, plan_.jobs[r.id], ++done_, plan_.jobs.size());
      return request_.keep_going || r.outcome != CellOutcome::failed;
    };
    e.on_death = [this](int rank, const std::string& why) {
      ++summary_.process_deaths;
      progress_.noted("the bake process of rank " + std::to_string(rank) + " is started again: " + why);
    };
    e.on_lost = [this](int rank) {
      progress_.noted("nothing heard of rank " + std::to_string(rank) + "; its cells are baked elsewhere");
    };
    e.should_drain = is_drain_asked;
    return e;
  }

  void publish() {
    out_.expect_shards(summary_.scene);
    if (summary_.is_drained && out_.has_whole_scene()) return;  // until this one is whole, too
    refuse(request_, summary_.scene.losses, summary_.scene.cells.empty() && !summary_.is_drained);
    if (!summary_.scene.cells.empty()) out_.publish(summary_.scene);
    if (request_.prune && summary_.scene.losses.empty()) summary_.pruned = out_.remove_orphans(summary_.scene);
    summary_.orphans = out_.orphans(summary_.scene);
  }

  const BakeRequest& request_;
  const SceneSources& sources_;
  const BakePlan& plan_;
  const OutputFolder& out_;
  const BakeProgress& progress_;
  BakeSummary& summary_;
  std::size_t done_ = 0;
};

}  // namespace

BakePlan plan_bake(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress) {
  end_with_mpirun();
  const SceneSources sources = open_together(mpi, request, progress);
  BakeRequest on_cpu = request;
  on_cpu.backend = Backend::cpu;  // a survey needs no device
  BakeProcess process(setup_of(mpi, on_cpu, sources), process_options(request));
  return survey_and_plan(mpi, request, sources, process, progress);
}

BakeSummary bake(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress) {
  const auto start = Clock::now();
  watch_for_drain();
  end_with_mpirun();
  BakeSummary summary;
  summary.ranks = mpi.ranks();
  summary.threads = threads_of(mpi, request);
  warn_of_binding(mpi, request);
  const SceneSources sources = open_together(mpi, request, progress);
  std::optional<OutputFolder> out;
  all_or_none(mpi, [&] {
    if (mpi.rank() == 0) out.emplace(request.out, request.source);
  });
  all_or_none(mpi, [&] { expect_output_folder(request.out); });
  BakeProcess process(setup_of(mpi, request, sources), process_options(request));
  choose_devices(mpi, process, summary);
  const BakePlan plan = survey_and_plan(mpi, request, sources, process, progress);
  all_or_none(mpi, [&] { refuse(request, plan.losses, mpi.rank() == 0 && plan.jobs.empty()); });
  summary.survey_s = seconds_since(start);
  const auto planned = Clock::now();
  std::optional<std::string> failure;
  if (mpi.rank() != 0) work(mpi, process);
  try {
    if (mpi.rank() == 0) MasterBake(request, sources, plan, *out, progress, summary).run(mpi, process);
  } catch (const std::exception& e) {
    failure = e.what();
  }
  if (summary.lost_ranks != 0) {
    if (failure) throw std::runtime_error(*failure);
  } else {
    fail_together(mpi, failure);
  }
  summary.bake_s = seconds_since(planned);
  return summary;
}

}  // namespace gigabake
