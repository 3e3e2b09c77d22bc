/// First hits of any number of rays through a baked scene, in bounded memory.
///
/// Rays are taken in batches. All of a batch go on until each is answered or needs a tree that is not in memory; then
/// the trees that most rays wait for are built from their shards, and those that were used longest ago go.
/// Source  Pharr, Kolb, Gershbein, Hanrahan 1997, "Rendering complex scenes with memory-coherent ray tracing".
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "format/scene/paged_scene.h"
#include "lattice/progress.h"
#include "lattice/thread_pool.h"
#include "viewer/query/query_ray.h"

namespace gigabake {

struct QueryOptions {
  int lod = 0;        ///< the finest level that is looked at
  double spread = 0;  ///< growth of a ray's footprint with its way; 0: the level `lod` all the way (query_walk.h)
  /// Of trees, and of those being built. Next to it pages of the scene take a thirty-second part, 1 MiB at least.
  std::uint64_t memory_bytes = std::uint64_t(1) << 30;
};

struct QueryCounts {
  std::uint64_t trees_built = 0;  ///< a tree that went and came again counts again
  std::uint64_t peak_bytes = 0;   ///< of trees, those being built included
  std::uint64_t pages_read = 0;   ///< of the scene, since rays came to their blocks; 0: scene.xml says all
};

class SceneQuery {
 public:
  /// Borrows the pool; its threads cast rays and build trees.
  /// Errors  InputError: a scene that cannot be read, or whose cells are no lattice; UsageError: a level that the scene
  ///         does not have, a spread that is no number from 0 to 1.
  SceneQuery(std::shared_ptr<const PagedScene> scene, const QueryOptions& options, const ThreadPool& pool);
  ~SceneQuery();

  const PagedScene& scene() const;
  /// Around all cells, lost ones too; lod-0 voxels.
  const kernels::VoxelBox& window() const;
  int lods() const;  ///< levels that can be asked for

  /// answers: as many as rays.
  /// Range   Rays of length 1, of finite numbers but for `end`, that begin within 2^50 voxels of the lattice's corner.
  /// Cost    Besides memory_bytes some 150 bytes a ray: callers with many rays call it with batches.
  /// Errors  UsageError: memory_bytes that do not hold the tree of one shard; Stopped.
  void first_hits(std::span<const QueryRay> rays, std::span<QueryHit> answers, const Progress& progress = {});

  /// The cell's or parent's name.
  /// Errors  InputError as NumberedShards.
  const std::string& name_of(std::uint32_t shard);

  QueryCounts counts() const;
  /// One line for each shard that could not be read.
  const std::vector<std::string>& problems() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Whether the ray is one that first_hits() takes.
bool is_valid(const QueryRay& ray);

}  // namespace gigabake
