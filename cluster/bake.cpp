#include "cluster/bake.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>

#include "cluster/dispatch.h"
#include "cluster/survey.h"
#include "format/error.h"
#include "format/publish.h"
#include "scheduler/merge.h"

namespace gigabake {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

int threads_of(const MpiSession& mpi, const BakeRequest& request) {
  if (request.threads > 0) return request.threads;
  return std::max(1, int(std::thread::hardware_concurrency()) / mpi.ranks_on_this_host());
}

/// Runs `work` on every rank; where it throws anywhere, every rank throws: the line itself on the rank that has it.
template <class Work>
void all_or_none(MpiSession& mpi, const Work& work) {
  std::exception_ptr error;
  try {
    work();
  } catch (...) {
    error = std::current_exception();
  }
  const int failing = mpi.max_of(error ? mpi.ranks() - mpi.rank() : 0);  // rank 0's word counts most
  if (failing == 0) return;
  if (error && mpi.ranks() - mpi.rank() == failing) std::rethrow_exception(error);
  throw OtherRankFailed();
}

void make_out(const std::filesystem::path& out) {
  std::error_code error;
  std::filesystem::create_directories(out / "shards", error);
  if (error) throw InputError(out, "", "cannot make the output folder: " + error.message());
  const Publication writable(out / "scene.xml");  // fails now rather than after the night
}

/// Shards of earlier bakes, once the new scene.xml no longer names them, and what interrupted writers left.
void remove_unused_shards(const std::filesystem::path& out, const SceneDescription& scene) {
  std::set<std::string> used;
  for (const SceneCell& c : scene.cells) used.insert(std::filesystem::path(c.file).filename().string());
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(out / "shards", error)) {
    const std::string name = entry.path().filename().string();
    const bool is_shard = name.starts_with("c_") && name.ends_with(".h5");
    const bool is_leftover = name.starts_with(".c_") && name.ends_with(".part");
    if ((is_shard && !used.contains(name)) || is_leftover) std::filesystem::remove(entry.path(), error);
  }
}

struct Planned {
  SceneSources sources;
  BakePlan plan;
};

Planned open_and_plan(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress) {
  Planned p;
  all_or_none(mpi, [&] { p.sources = open_sources(request.source, request.source_options); });
  if (mpi.rank() == 0 && progress.opened) progress.opened(p.sources);
  std::vector<TileSurvey> surveys = survey_tiles(mpi, p.sources, request.parameters, threads_of(mpi, request));
  all_or_none(mpi, [&] {
    if (mpi.rank() != 0) return;
    std::vector<std::string> names;
    for (const TileRef& t : p.sources.tiles) names.push_back(t.name);
    p.plan = make_plan(std::move(surveys), names, request.parameters, p.sources.origin);
    const bool has_losses =
        !p.plan.losses.empty() || std::any_of(p.sources.skipped.begin(), p.sources.skipped.end(),
                                              [](const SkippedSource& s) { return !s.informative; });
    if (p.plan.jobs.empty() && !has_losses) throw InputError(request.source, "", "holds no triangles to bake");
  });
  if (mpi.rank() == 0 && progress.planned) progress.planned(p.plan);
  return p;
}

void add_times(const std::vector<CellReport>& reports, BakeSummary& summary) {
  for (const CellReport& r : reports) {
    summary.read_s += r.read_s;
    summary.kernel_s += r.kernel_s;
    summary.write_s += r.write_s;
    summary.peak_kernel_bytes = std::max(summary.peak_kernel_bytes, r.peak_bytes);
    summary.cells_empty += r.outcome == CellOutcome::empty;
  }
}

void bake_as_master(MpiSession& mpi, const BakeRequest& request, const Planned& p, const MakePipeline& make_pipeline,
                    const BakeProgress& progress, BakeSummary& summary) {
  std::size_t done = 0;
  const auto on_report = [&](const CellReport& r) {
    if (progress.cell_done) progress.cell_done(r, p.plan.jobs[r.id], ++done, p.plan.jobs.size());
    return request.keep_going || r.outcome != CellOutcome::failed;
  };
  const std::vector<CellReport> reports = dispatch(mpi, p.plan.jobs, make_pipeline, on_report);
  summary.cells_planned = p.plan.jobs.size();
  add_times(reports, summary);
  summary.scene = merge(p.plan, reports, p.sources, request.parameters);
  write_scene(request.out / "scene.xml", summary.scene);
  remove_unused_shards(request.out, summary.scene);
}

}  // namespace

BakePlan plan_bake(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress) {
  return open_and_plan(mpi, request, progress).plan;
}

BakeSummary bake(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress) {
  BakeSummary summary;
  summary.ranks = mpi.ranks();
  summary.threads = threads_of(mpi, request);
  all_or_none(mpi, [&] {
    if (mpi.rank() == 0) make_out(request.out);
  });
  const auto start = Clock::now();
  const Planned p = open_and_plan(mpi, request, progress);
  summary.survey_s = seconds_since(start);
  const auto planned = Clock::now();
  const MakePipeline make_pipeline = [&] {
    return std::make_unique<CellPipeline>(p.sources, request.parameters,
                                          WorkerOptions{summary.threads, request.memory_bytes, request.out});
  };
  if (mpi.rank() != 0) work(mpi, make_pipeline);
  all_or_none(mpi, [&] {
    if (mpi.rank() == 0) bake_as_master(mpi, request, p, make_pipeline, progress, summary);
  });
  summary.bake_s = seconds_since(planned);
  return summary;
}

}  // namespace gigabake
