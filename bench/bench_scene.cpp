#include "bench/bench_scene.h"

#include <thread>

#include "core/base/error.h"
#include "core/base/thread_pool.h"
#include "scheduler/plan/merge.h"
#include "worker/scan/scan_tile.h"

namespace gigabake::bench {

BakePlan plan_scene(const SceneSources& sources, const BenchScene& scene) {
  const ThreadPool pool(scene.threads);
  std::vector<TileScan> scans;
  for (std::uint32_t t = 0; t < sources.tiles.size(); ++t)
    scans.push_back(scan_tile(sources, t, scene.parameters, pool));
  BakePlan plan = make_plan(std::move(scans), sources, scene.parameters, PlanLevels::cells, scene.progress);
  if (plan.jobs.empty()) throw InputError(scene.source, "", "holds no triangles to bake");
  return plan;
}

std::vector<CellReport> bake_cells(CellPipeline& pipeline, const std::vector<CellJob>& jobs, std::size_t in_flight,
                                   const Progress& progress) {
  std::vector<CellReport> reports;
  for (std::size_t next = 0; reports.size() < jobs.size();) {
    progress.advance(0);
    while (next < jobs.size() && pipeline.in_flight() < in_flight) pipeline.submit(jobs[next++]);
    if (auto report = pipeline.poll()) {
      if (report->outcome == CellOutcome::failed) throw InputError(jobs[report->id].name, "", report->error);
      reports.push_back(std::move(*report));
      progress.advance();
    } else {
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  }
  return reports;
}

std::vector<CellReport> bake_scene(const SceneSources& sources, const BenchScene& scene,
                                   const std::optional<int>& device, const std::filesystem::path& out) {
  constexpr std::size_t cells_in_flight = 4;
  const BakePlan plan = plan_scene(sources, scene);
  CellPipeline pipeline(sources, scene.parameters, WorkerOptions{scene.threads, scene.memory_bytes, out, device});
  std::vector<CellReport> reports = bake_cells(pipeline, plan.jobs, cells_in_flight, scene.progress);
  write_scene(out / "scene.xml", merge(plan, reports, sources.origin, scene.parameters));
  return reports;
}

}  // namespace gigabake::bench
