/// Times first hits through a whole scene, view by view and backend by backend, and counts what they got wrong.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gigabake::bench {

struct FirstHitBenchRequest {
  std::filesystem::path scene;  ///< scene.xml of a bake
  int lod = 0;                  ///< the finest level of the tree
  int width = 1920, height = 1080;
  int repeats = 20;  ///< of each view, after one that warms up; at most three on the CPU
  int threads = 1;   ///< of the CPU
  bool cpu = true;
  std::optional<int> device;          ///< of CUDA
  std::size_t reference_rays = 2000;  ///< of each view that are compared with the reference
};

/// One view on one backend. Seconds for all its rays; the device's are by its own clock, without transfers.
struct FirstHitTimes {
  std::string backend;  ///< "cpu" or "cuda"
  double best_s = 0, median_s = 0;
  double best_with_looks_s = 0, median_with_looks_s = 0;  ///< colours and normals are fetched too
};

struct FirstHitRow {
  std::string view;
  std::uint64_t rays = 0, hits = 0;
  int beam_tile = 0;  ///< pixels an edge; 0: none
  std::vector<FirstHitTimes> times;
  std::uint64_t differ = 0;  ///< between the backends
  std::uint64_t reference_rays = 0, within_rounding = 0, wrong = 0;
};

struct FirstHitBench {
  int width = 0, height = 0, lod = 0;
  std::uint64_t voxels = 0, nodes = 0, tree_bytes = 0, bytes = 0;
  double build_s = 0;  ///< read from the shards included
  std::vector<FirstHitRow> rows;

  /// Hits of all views together.
  std::uint64_t hits() const;
  /// Whether any ray is wrong or differs, or no ray hit a voxel.
  bool failed() const;
};

/// Errors  InputError: a scene or a shard that cannot be read, too wide for one tree; CudaFailure.
FirstHitBench bench_first_hits(const FirstHitBenchRequest& request);

}  // namespace gigabake::bench
