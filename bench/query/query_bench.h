/// Compares the first hits of `gigabake query` and of Embree, for rays through the voxels of a level as cubes. Every
/// disagreement is classified.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace gigabake::bench {

struct QueryBenchRequest {
  std::filesystem::path scene;
  int lod = 0;
  std::uint64_t rays = 1000000;
  std::uint64_t seed = 1;
  int threads = 1;
  std::uint64_t memory_bytes = std::uint64_t(1) << 30;
  std::optional<int> device = {};  ///< CUDA device whose answers are compared with the CPU's
};

struct QueryBench {
  std::uint64_t rays = 0, hits = 0, trees_built = 0;
  double query_s = 0, build_and_query_s = 0;  ///< seconds without and with building trees
  double cpu_s = 0;                           ///< CPU seconds of all threads during query_s, independent of other load
  double device_s = 0;                        ///< time of the device, including transfers, once it has the trees
  std::uint64_t device_rays = 0;              ///< rays that the device finished; all rays are cast twice
  std::uint64_t differ = 0;                   ///< answers of the device that differ from the CPU's answers in any bit
  std::uint64_t same = 0;                     ///< rays for which both hit the same voxel, or both hit none
  /// Rays whose two hits are different voxels or sides, and that penetrate the missed voxel by less than 1/64 voxel.
  std::uint64_t grazing = 0;
  std::uint64_t inside = 0;  ///< rays that start in a voxel or up to 1/64 voxel in front of a voxel; not compared
  std::uint64_t wrong = 0;   ///< all other rays
  double max_gap = 0;        ///< maximum distance between hits of the same voxel, lod-0 voxels
  std::string first_wrong;   ///< the first wrong ray; empty if there is none

  /// Returns the number of compared rays that hit a voxel in `gigabake query`.
  std::uint64_t compared_hits() const { return hits - inside; }
  /// Returns true if a ray is wrong or differs between the backends, or no hit was compared.
  bool failed() const { return wrong != 0 || differ != 0 || compared_hits() == 0; }
};

/// Runs the comparison.
/// Cost    Embree stores up to six faces per voxel that no neighbour covers: about 400 bytes per voxel.
/// Errors  UsageError: built without Embree; more than 2^23 voxels. InputError: see SceneQuery.
///         CudaFailure: the device failed.
QueryBench bench_queries(const QueryBenchRequest& request);

}  // namespace gigabake::bench
