/// A tile as cells want it: read once; large meshes in clusters, each with bounds.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "format/source/mesh.h"
#include "lattice/parameters.h"
#include "lattice/thread_pool.h"
#include "worker/instance_bounds.h"
#include "worker/tiles/tile_directory.h"
#include "worker/tiles/tile_file.h"

namespace gigabake {

/// Immutable: cells on several threads read it.
class LoadedTile {
 public:
  /// file: where clusters without a mesh are; null: all have theirs. Primitives in memory that reach over several cells
  /// of parameters.cell_voxels are cut into clusters, on the pool's threads.
  LoadedTile(TileDirectory&& directory, std::shared_ptr<const TileFile> file, const BakeParameters& parameters,
             const ThreadPool& pool);

  const TileMesh& mesh() const { return directory_.mesh; }  ///< without images and the triangles of its primitives
  const std::vector<TilePrimitive>& primitives() const { return directory_.primitives; }
  /// By instance: a box that holds every voxel that it can touch.
  const std::vector<SceneBox>& instance_boxes() const { return boxes_; }
  const std::vector<TileImage>& images() const { return directory_.images; }
  /// With its bytes. Errors  As TileFile::read().
  EncodedImage encoded(std::size_t image) const;

  /// Some clusters of a primitive, as one mesh; null: none. Cost  One of them that is in memory is not copied.
  /// Errors  As TileFile::read().
  std::shared_ptr<const Primitive> mesh_of(const std::vector<const TileCluster*>& clusters) const;
  /// All of a primitive's triangles.
  std::shared_ptr<const Primitive> whole(std::size_t primitive) const;

  std::uint64_t bytes() const;  ///< in memory

 private:
  std::shared_ptr<const Primitive> mesh_of(const TileCluster& cluster) const;
  void cut(const BakeParameters& parameters, const ThreadPool& pool);

  TileDirectory directory_;
  std::shared_ptr<const TileFile> file_;
  std::vector<SceneBox> boxes_;
};

}  // namespace gigabake
