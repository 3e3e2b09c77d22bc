/// Times whole cells, from files to shards: each stage alone, then all of them overlapped.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "bench/bench_scene.h"
#include "worker/backend.h"

namespace gigabake::bench {

struct BakeBenchRequest {
  BenchScene scene;
  std::filesystem::path out;  ///< shards go to OUT/shards and replace those there; holds no scene
  Backend backend = Backend::automatic;
  std::size_t most_cells = 16;  ///< of the plan, the first ones
};

/// Seconds, summed over the cells.
struct StageSeconds {
  double read = 0, kernels = 0, write = 0;
  double slowest() const;
  const char* slowest_name() const;
};

struct BakeBench {
  std::string backend;  ///< "cpu" or "cuda": where the kernels ran
  std::size_t cells = 0;
  std::uint64_t triangles = 0, voxels = 0, bytes = 0;
  StageSeconds alone;       ///< one cell at a time, so that no stage waits for cores that another uses
  StageSeconds overlapped;  ///< of the run below
  double bake_s = 0;        ///< wall time with three cells in flight
  bool differ = false;      ///< the two runs' content hashes
  std::string content_hash;
};

/// One process, no MPI. Errors  InputError: as a bake, a cell that failed, or no voxels; UsageError.
BakeBench bench_bake(const BakeBenchRequest& request);

}  // namespace gigabake::bench
