/// Times first hits through a whole scene, for each view and backend, and counts wrong hits.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gigabake::bench {

struct FirstHitBenchRequest {
  std::filesystem::path scene;  ///< scene.xml of a bake
  int lod = 0;                  ///< finest level of the tree
  int width = 1920, height = 1080;
  int repeats = 20;  ///< per view, after a warm-up run; at most three on the CPU
  int threads = 1;   ///< of the CPU backend
  bool cpu = true;
  std::optional<int> device;          ///< CUDA device
  std::size_t reference_rays = 2000;  ///< rays per view that are compared with the reference
};

/// Times of one view on one backend: seconds for all its rays. The device measures its own time, without transfers.
struct FirstHitTimes {
  std::string backend;  ///< "cpu" or "cuda"
  double best_s = 0, median_s = 0;
  double best_with_looks_s = 0, median_with_looks_s = 0;  ///< times when colours and normals are fetched too
};

struct FirstHitRow {
  std::string view;
  std::uint64_t rays = 0, hits = 0;
  int beam_tile = 0;  ///< edge of the tile of a beam in pixels; 0: no beams
  std::vector<FirstHitTimes> times;
  std::uint64_t differ = 0;  ///< hits that differ between the backends
  std::uint64_t reference_rays = 0, within_rounding = 0, wrong = 0;
};

struct FirstHitBench {
  int width = 0, height = 0, lod = 0;
  std::uint64_t voxels = 0, nodes = 0, tree_bytes = 0, bytes = 0;
  double build_s = 0;  ///< time to build the tree, including reading the shards
  std::vector<FirstHitRow> rows;

  /// Returns the total number of hits of all views.
  std::uint64_t hits() const;
  /// Returns true if any ray is wrong or differs, or no ray hit a voxel.
  bool failed() const;
};

/// Times all views of a scene.
/// Errors  InputError: a scene or a shard cannot be read, or is too wide for one tree. CudaFailure.
FirstHitBench bench_first_hits(const FirstHitBenchRequest& request);

}  // namespace gigabake::bench
