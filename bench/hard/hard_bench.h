/// The hard cases: a suite of scenes that are made to break a voxelizer. The suite runs on any machine. Each case is
/// written as files, baked as a cell by the pipeline of every bake, and read back from its shard. The result is
/// compared with an independent reference: long double placements, rational clipping, closed forms, and sets derived by
/// hand.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/accuracy/leaks/leak_bench.h"
#include "worker/device/backend.h"

namespace gigabake::bench {

struct HardBenchRequest {
  std::filesystem::path out;  ///< a folder per case: its scene and its shard, which are replaced
  Backend backend = Backend::automatic;
  int threads = 1;
  /// The number of millions of triangles in one voxel. The published suite has 17.
  int million_triangles = 17;
};

struct HardRange {
  double low = 0, high = 0;
  bool contains(double value) const { return low <= value && value <= high; }
};

/// A measured number and its bound.
struct HardFigure {
  std::string name;  ///< "missed", "colour"; the same name has the same meaning in all cases
  std::string unit;  ///< "voxels", "codes", "°", "m", …
  double measured = 0, bound = 0;
  std::optional<HardRange> goal{};   ///< the desired range, which may be narrower than the bounds
  std::optional<double> at_least{};  ///< lower bound
  bool holds() const { return measured <= bound && !(at_least && measured < *at_least); }
};

struct HardResult {
  std::string name, group;
  std::string what;          ///< the difficulty of the case, and the reference for its result
  std::uint64_t voxels = 0;  ///< number of baked voxels
  std::vector<HardFigure> figures;
  std::string error;  ///< one line; if not empty, the case was not measured, or a GPU rejected the cell
  bool holds() const;
};

struct HardBench {
  std::string backend;  ///< "cpu" or "cuda"
  std::vector<HardResult> cases;
  LeakBench leaks = {};  ///< leaks of three planes; they are reported, but are not part of holds()
  bool holds() const;
};

/// Runs all cases and calls `done` after each. A failure of a case is part of its result.
/// Cost    Twenty CPU seconds and about 270 flushes to disk; 1.6 GB for the 17 million triangles.
/// Errors  UsageError: cuda without a device, or this build has no exact reference. InputError: `out` cannot be
///         written.
HardBench bench_hard(const HardBenchRequest& request, const std::function<void(const HardResult&)>& done);

}  // namespace gigabake::bench
