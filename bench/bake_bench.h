/// Times whole cells, from files to shards: each stage separately, then all stages overlapped.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "bench/bench_scene.h"
#include "worker/device/backend.h"

namespace gigabake::bench {

struct BakeBenchRequest {
  BenchScene scene;
  std::filesystem::path out;  ///< output folder; its shards/*.h5 are replaced, and it contains no scene.xml
  Backend backend = Backend::automatic;
  std::size_t max_cells = 16;  ///< max number of cells, from the start of the plan
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
  StageSeconds alone;       ///< one cell in flight, so that stages do not compete for cores
  StageSeconds overlapped;  ///< seconds of the run that bake_s measures
  double bake_s = 0;        ///< wall time with three cells in flight
  bool differ = false;      ///< the content hashes of the two runs differ
  std::string content_hash;
};

/// Measures a bake in one process, without MPI.
/// Errors  InputError: as a bake, a cell that failed, or no voxels. UsageError.
BakeBench bench_bake(const BakeBenchRequest& request);

}  // namespace gigabake::bench
