/// What the benchmarks have in common: a scene, its plan made in this process, and what one stop watch says.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "format/parameters.h"
#include "format/source.h"
#include "scheduler/plan.h"

namespace gigabake::bench {

struct BenchScene {
  std::filesystem::path source;
  SourceOptions source_options;
  BakeParameters parameters;
  int threads = 1;
  std::uint64_t memory_bytes = 0;
};

/// Errors  InputError: as a bake of it; no triangles.
std::vector<CellJob> plan_cells(const SceneSources& sources, const BenchScene& scene);

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace gigabake::bench
