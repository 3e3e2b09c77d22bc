/// A tile as cells want it: read once, large meshes in clusters, each with bounds.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "format/source/mesh.h"
#include "format/source/source.h"
#include "lattice/hash128.h"
#include "lattice/parameters.h"
#include "lattice/thread_pool.h"
#include "worker/instance_bounds.h"

namespace gigabake {

struct TileCluster {
  LocalBounds bounds;
  std::shared_ptr<const Primitive> mesh;
};

/// A primitive of TileMesh: whole, or in clusters (worker/tiles/clusters.h).
struct TilePrimitive {
  LocalBounds bounds;  ///< of all clusters
  std::uint64_t triangles = 0;
  std::vector<TileCluster> clusters;  ///< one: whole
};

/// Immutable once made; cells on several threads read it.
class LoadedTile {
 public:
  /// expected: tile_hash() of what was surveyed; none: whatever the files hold now. Primitives that reach over several
  /// cells of parameters.cell_voxels are cut into clusters, on the pool's threads.
  /// Errors  InputError, as read_tile; and where the files do not hold what was surveyed.
  static std::shared_ptr<const LoadedTile> read(const TileRef& tile, const SceneSources& sources,
                                                const BakeParameters& parameters,
                                                const std::optional<Hash128>& expected, const ThreadPool& pool);

  const std::vector<Instance>& instances() const { return mesh_.instances; }
  /// By instance: a box that holds every voxel that it can touch.
  const std::vector<SceneBox>& instance_boxes() const { return boxes_; }
  const std::vector<TilePrimitive>& primitives() const { return primitives_; }
  const std::vector<Material>& materials() const { return mesh_.materials; }
  /// By primitive: index into materials().
  std::size_t material_of(std::size_t primitive) const { return std::size_t(mesh_.primitives[primitive].material); }
  const std::vector<EncodedImage>& images() const { return mesh_.images; }
  /// Of the encoded bytes: tiles that share an image share its textures.
  const std::vector<Hash128>& image_hashes() const { return image_hash_; }
  std::uint64_t bytes() const;

 private:
  void find_boxes(const BakeParameters& parameters);
  void cut(const BakeParameters& parameters, const ThreadPool& pool);

  TileMesh mesh_;  ///< its primitives keep only what is not of their triangles
  std::vector<TilePrimitive> primitives_;
  std::vector<SceneBox> boxes_;
  std::vector<Hash128> image_hash_;
};

}  // namespace gigabake
