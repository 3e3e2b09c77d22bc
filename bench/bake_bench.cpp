#include "bench/bake_bench.h"

#include <algorithm>
#include <fmt/format.h>
#include <memory>

#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "scheduler/queue/schedule.h"
#include "worker/pipeline/writer_pool_size.h"

namespace gigabake::bench {
namespace {

WorkerOptions worker_options(const BakeBenchRequest& request, const std::optional<int>& device) {
  return {request.scene.threads, request.scene.memory_bytes, request.out, device};
}

std::unique_ptr<CellPipeline> make_pipeline(const SceneSources& sources, const BakeBenchRequest& request,
                                            const std::optional<int>& device) {
  std::filesystem::remove_all(request.out / "shards");
  return std::make_unique<CellPipeline>(sources, request.scene.parameters, worker_options(request, device));
}

StageSeconds stages(const std::vector<CellReport>& reports) {
  StageSeconds s;
  for (const CellReport& r : reports) {
    s.read += r.read_s;
    s.kernels += r.kernel_s;
    s.write += r.write_s;
  }
  return s;
}

Hash128 content(const std::vector<CellReport>& reports) {
  Hash128 all;
  for (const CellReport& r : reports)
    for (const Hash128& lod : r.cell.content_hash) all += lod;
  return all;
}

}  // namespace

double StageSeconds::slowest() const { return std::max({read, kernels, write}); }

const char* StageSeconds::slowest_name() const {
  return slowest() == write ? "write" : (slowest() == kernels ? "kernels" : "read");
}

BakeBench bench_bake(const BakeBenchRequest& request) {
  if (std::filesystem::exists(request.out / "scene.xml"))
    throw InputError(request.out, "", "holds a scene; a benchmark would replace its shards, choose another folder");
  const SceneSources sources = open_sources(request.scene.source, request.scene.source_options, request.scene.progress);
  const DeviceChoice device = choose_device({request.backend});
  std::vector<CellJob> jobs = plan_scene(sources, request.scene).jobs;
  if (jobs.size() > request.max_cells) jobs.resize(request.max_cells);
  BakeBench b;
  b.backend = device.device ? "cuda" : "cpu";
  const Progress& progress = request.scene.progress;
  progress.step("baking cells one by one", jobs.size(), "cell");
  const std::vector<CellReport> one_by_one =
      bake_cells(*make_pipeline(sources, request, device.device), jobs, 1, progress);
  b.alone = stages(one_by_one);
  // Like in a bake, a device's driver is initialized while tiles are scanned.
  const std::unique_ptr<CellPipeline> pipeline = make_pipeline(sources, request, device.device);
  plan_scene(sources, request.scene);
  progress.step("baking cells overlapped", jobs.size(), "cell");
  const auto start = Clock::now();
  const WorkerOptions worker = worker_options(request, device.device);
  const int in_hand = slots_of_worker(device.device.has_value(), int(concurrent_cells_for(worker)),
                                      writer_pool_size_for(worker).writers);
  const std::vector<CellReport> together = bake_cells(*pipeline, jobs, std::size_t(in_hand), progress);
  b.bake_s = seconds_since(start);
  b.overlapped = stages(together);
  b.cells = together.size();
  for (const CellReport& r : together) {
    b.triangles += r.cell.triangles;
    b.bytes += r.cell.bytes;
    for (const std::uint64_t v : r.cell.voxels) b.voxels += v;
  }
  if (b.voxels == 0)
    throw InputError(request.scene.source, "",
                     fmt::format("its first {} have no voxels, so nothing was measured; expected a surface that is "
                                 "visible at this voxel size",
                                 pluralize(b.cells, "cell")));
  b.content_hash = content(together).hex();
  b.differ = content(one_by_one) != content(together);
  return b;
}

}  // namespace gigabake::bench
