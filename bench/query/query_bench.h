/// What `gigabake query` answers against Embree: rays through the cubes of all voxels of a level, every disagreement
/// looked at.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace gigabake::bench {

struct QueryBenchRequest {
  std::filesystem::path scene;
  int lod = 0;
  std::uint64_t rays = 1000000;
  std::uint64_t seed = 1;
  int threads = 1;
  std::uint64_t memory_bytes = std::uint64_t(1) << 30;
};

struct QueryBench {
  std::uint64_t rays = 0, hits = 0, trees_built = 0;
  double query_s = 0, build_and_query_s = 0;  ///< without and with the building of trees
  double cpu_s = 0;                           ///< of all threads in query_s, however busy the machine is
  std::uint64_t same = 0;                     ///< both meet the same voxel, or nothing
  /// Another voxel, or another side of it, and what one of the two passed is met by less than 1/64 of a voxel.
  std::uint64_t grazing = 0;
  std::uint64_t inside = 0;  ///< rays that begin in a voxel or 1/64 of one before it; not compared
  std::uint64_t wrong = 0;   ///< none of these
  double largest_gap = 0;    ///< between the distances of the same voxel, lod-0 voxels
  std::string first_wrong;   ///< such a ray; empty where there is none

  /// Rays that hit a voxel here and were compared.
  std::uint64_t compared_hits() const { return hits - inside; }
  /// Whether a ray is wrong, or no hit was compared.
  bool failed() const { return wrong != 0 || compared_hits() == 0; }
};

/// Cost    Embree holds six faces of each voxel that is not covered: some 400 bytes a voxel.
/// Errors  UsageError: built without Embree; more than 2^23 voxels; InputError, as SceneQuery.
QueryBench bench_queries(const QueryBenchRequest& request);

}  // namespace gigabake::bench
