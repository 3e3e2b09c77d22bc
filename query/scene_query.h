/// First hits of any number of rays through a baked scene, in bounded memory.
///
/// Rays are traversed in batches. All rays of a batch continue until each is finished or needs a tree that is not
/// resident. Then the trees with the largest number of waiting rays are built from their shards; the least recently
/// used trees are evicted. A device casts long batches through the trees that it holds; the CPU resumes the rays that
/// need other trees, and the device then receives these trees.
/// Source  Pharr, Kolb, Gershbein, Hanrahan 1997, "Rendering complex scenes with memory-coherent ray tracing".
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/thread_pool.h"
#include "format/scene/paged_scene.h"
#include "query/first_hit/query_ray.h"

namespace gigabake {

struct QueryOptions {
  int lod = 0;        ///< finest level that rays sample
  double spread = 0;  ///< growth of a ray's footprint with distance; 0: samples only `lod`
  /// The maximum memory of trees, including trees being built. Pages of the scene take up to 1/32 of this value in
  /// addition, at least 1 MiB.
  std::uint64_t memory_bytes = std::uint64_t(1) << 30;
  /// Returns the ordinal of the CUDA device that casts rays. It is called once, at the first batch of at least
  /// `min_device_rays` rays. If the function is null or returns nullopt, the CPU casts all rays.
  std::function<std::optional<int>()> device = {};
  std::size_t min_device_rays = std::size_t(1) << 15;
  std::uint64_t device_bytes = std::uint64_t(4) << 30;  ///< bound of the device's memory
};

struct QueryCounts {
  std::uint64_t trees_built = 0;  ///< a tree that is evicted and rebuilt counts again
  std::uint64_t peak_bytes = 0;   ///< max. memory of trees, including trees being built
  std::uint64_t pages_read = 0;   ///< pages of the scene that rays caused to be read; 0 if all are read at the start
  std::uint64_t device_rays = 0;  ///< rays that the device finished
};

class SceneQuery {
 public:
  /// Borrows the pool; its threads cast rays and build trees.
  /// Errors  InputError: the scene cannot be read, or lay_out_cells() rejects its cells. UsageError: the scene does not
  ///         have the level, or the spread is not in [0, 1].
  SceneQuery(std::shared_ptr<const PagedScene> scene, const QueryOptions& options, const ThreadPool& pool);
  ~SceneQuery();

  const PagedScene& scene() const;
  /// Returns the bounding box of all cells, including lost ones; lod-0 voxels.
  const kernels::VoxelBox& window() const;
  int lods() const;  ///< number of levels

  /// Casts all rays and writes one answer per ray.
  /// Exact   The answers have the same bits for any memory, number of threads, batches and device.
  /// Range   Directions have unit length. All numbers except `end` are finite. Origins lie within 2^50 voxels of the
  ///         lattice's origin. `answers` has the size of `rays`.
  /// Cost    Uses about 150 bytes per ray in addition to memory_bytes. Cast many rays in batches.
  /// Errors  UsageError: memory_bytes is less than the tree of one shard requires. Stopped, if a stop is requested.
  void first_hits(std::span<const QueryRay> rays, std::span<QueryHit> answers, const Progress& progress = {});

  /// Returns the name of the cell or overview.
  /// Errors  InputError: the errors of NumberedShards.
  const std::string& name_of(std::uint32_t shard);

  QueryCounts counts() const;
  /// Returns one line for each shard that could not be read.
  const std::vector<std::string>& problems() const;
  /// Returns why the CPU casts rays although there is a device; empty if the device casts all rays of long batches.
  const std::string& device_problem() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Returns whether first_hits() accepts the ray.
bool is_valid(const QueryRay& ray);

}  // namespace gigabake
