/// A tile prepared for cells: the file is read once, and large meshes are split into clusters with bounds.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/octree/parameters.h"
#include "format/source/mesh.h"
#include "worker/scan/instance_bounds.h"
#include "worker/tiles/tile_directory.h"
#include "worker/tiles/tile_file.h"

namespace gigabake {

/// A tile in memory. It is immutable, because cells on several threads read it.
class LoadedTile {
 public:
  /// `file` holds the clusters that have no mesh in memory; it is null if all clusters are in memory. A primitive in
  /// memory that spans several cells of parameters.cell_voxels is split into clusters on the pool's threads.
  LoadedTile(TileDirectory&& directory, std::shared_ptr<const TileFile> file, const BakeParameters& parameters,
             const ThreadPool& pool);

  const TileMesh& mesh() const { return directory_.mesh; }  ///< without images and without the primitives' triangles
  const std::vector<TilePrimitive>& primitives() const { return directory_.primitives; }
  /// Returns one box per instance. The box contains every voxel that the instance can occupy.
  const std::vector<SceneBox>& instance_boxes() const { return boxes_; }
  const std::vector<TileImage>& images() const { return directory_.images; }
  /// Returns the image with its encoded bytes.
  /// Errors  The errors of TileFile::read().
  EncodedImage encoded(std::size_t image) const;

  /// Returns the given clusters of one primitive as one mesh; null if `clusters` is empty.
  /// Cost    A single cluster that is in memory is not copied.
  /// Errors  The errors of TileFile::read().
  std::shared_ptr<const Primitive> mesh_of(const std::vector<const TileCluster*>& clusters) const;
  /// Returns all triangles of a primitive as one mesh.
  std::shared_ptr<const Primitive> whole(std::size_t primitive) const;

  std::uint64_t bytes() const;  ///< size in memory

 private:
  std::shared_ptr<const Primitive> mesh_of(const TileCluster& cluster) const;
  void cut(const BakeParameters& parameters, const ThreadPool& pool);

  TileDirectory directory_;
  std::shared_ptr<const TileFile> file_;
  std::vector<SceneBox> boxes_;
};

}  // namespace gigabake
