/// Shared parts of the benchmarks: a scene, its plan and its bake in this process, and a clock.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/octree/parameters.h"
#include "format/source/source.h"
#include "scheduler/plan/plan.h"
#include "worker/pipeline/cell_pipeline.h"

namespace gigabake::bench {

struct BenchScene {
  std::filesystem::path source;
  SourceOptions source_options;
  BakeParameters parameters;
  int threads = 1;
  std::uint64_t memory_bytes = 0;
  Progress progress = {};
};

/// Scans the source and plans its cells.
/// Errors  InputError: as a bake; no triangles.
BakePlan plan_scene(const SceneSources& sources, const BenchScene& scene);

/// Bakes all jobs, with at most `in_flight` cells in the pipeline.
/// Errors  InputError: a cell failed. Stopped.
std::vector<CellReport> bake_cells(CellPipeline& pipeline, const std::vector<CellJob>& jobs, std::size_t in_flight,
                                   const Progress& progress = {});

/// Bakes a scene like `gigabake bake`, but in this process: plans, bakes, and writes shards and scene.xml into `out`,
/// which must not contain shards.
/// Errors  See plan_scene() and bake_cells().
std::vector<CellReport> bake_scene(const SceneSources& sources, const BenchScene& scene,
                                   const std::optional<int>& device, const std::filesystem::path& out);

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace gigabake::bench
