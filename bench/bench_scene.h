/// What the benchmarks have in common: a scene, its plan made in this process, cells baked in it, and what one stop
/// watch says.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "format/source/source.h"
#include "lattice/parameters.h"
#include "lattice/progress.h"
#include "scheduler/plan.h"
#include "worker/cell_pipeline.h"

namespace gigabake::bench {

struct BenchScene {
  std::filesystem::path source;
  SourceOptions source_options;
  BakeParameters parameters;
  int threads = 1;
  std::uint64_t memory_bytes = 0;
  Progress progress = {};
};

/// Errors  InputError: as a bake of it; no triangles.
BakePlan plan_scene(const SceneSources& sources, const BenchScene& scene);

/// All jobs, at most `in_flight` of them at a time. Errors  InputError: a cell that failed; Stopped.
std::vector<CellReport> bake_cells(CellPipeline& pipeline, const std::vector<CellJob>& jobs, std::size_t in_flight,
                                   const Progress& progress = {});

/// As `gigabake bake`, by this process alone: plans, bakes and writes shards and scene.xml into `out`, where no shards
/// are. Errors  as plan_scene() and bake_cells().
std::vector<CellReport> bake_scene(const SceneSources& sources, const BenchScene& scene,
                                   const std::optional<int>& device, const std::filesystem::path& out);

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace gigabake::bench
