/// What a tile's scratch file says besides the clusters' bytes: all that a cell asks before it reads one.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "format/source/mesh.h"
#include "worker/instance_bounds.h"
#include "worker/tiles/tile_file.h"

namespace gigabake {

struct TileCluster {
  LocalBounds bounds;
  std::shared_ptr<const Primitive> mesh;  ///< null: in the tile's scratch file
  StoredCluster stored = {};
};

/// A primitive of TileMesh: whole, or in clusters (worker/tiles/clusters.h).
struct TilePrimitive {
  LocalBounds bounds;  ///< of all clusters
  std::uint64_t triangles = 0;
  std::vector<TileCluster> clusters;  ///< one: whole
};

/// A tile without the triangles of its primitives.
struct TileDirectory {
  TileMesh mesh;  ///< its primitives keep `material` and `position_step`
  std::vector<TilePrimitive> primitives;
};

/// Clusters' meshes are left out.
std::vector<std::uint8_t> to_bytes(const TileDirectory& directory);
/// Errors  InputError: malformed, or an index beyond its list.
TileDirectory directory_from_bytes(std::span<const std::uint8_t> bytes);

}  // namespace gigabake
