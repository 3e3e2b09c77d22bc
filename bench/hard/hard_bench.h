/// The hard cases as a suite that anybody can run on his machine: scenes made to break a voxelizer, each written as
/// files, baked as a cell by the pipeline that bakes everything, read back from its shard, and held against an
/// independent reference: placements in long double, clipping in rationals, closed forms, sets worked out by hand.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "bench/accuracy/leaks/leak_bench.h"
#include "worker/backend.h"

namespace gigabake::bench {

struct HardBenchRequest {
  std::filesystem::path out;  ///< a folder for each case: its scene and its shard, which are replaced
  Backend backend = Backend::automatic;
  int threads = 1;
  /// Of the triangles in one voxel. The suite as it is published has 17 of them.
  int million_triangles = 17;
};

/// One measured number and what is claimed of it.
struct HardFigure {
  std::string name;  ///< "missed", "colour": equal names mean the same in each case
  std::string unit;  ///< "voxels", "codes", "°", "m", …
  double measured = 0, bound = 0;
  bool holds() const { return measured <= bound; }
};

struct HardResult {
  std::string name, group;
  std::string what;          ///< what is hard about it, and what it is held against
  std::uint64_t voxels = 0;  ///< that were baked
  std::vector<HardFigure> figures;
  std::string error;  ///< one line; not empty: there is nothing to measure, or a GPU handed the cell back
  bool holds() const;
};

struct HardBench {
  std::string backend;  ///< "cpu" or "cuda"
  std::vector<HardResult> cases;
  LeakBench leaks = {};  ///< of a few planes: measured, but not yet bounded, and so no part of holds()
  bool holds() const;
};

/// Cost    Ten seconds of a core, and some 250 flushes to disk; 1.6 GB for the 17 million triangles.
/// Errors  UsageError: cuda without a device, or this build has no exact reference; InputError: `out`. What goes wrong
///         with a case is its result.
HardBench bench_hard(const HardBenchRequest& request, const std::function<void(const HardResult&)>& done);

}  // namespace gigabake::bench
