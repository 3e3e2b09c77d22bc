/// What a tile's scratch file says besides the clusters' bytes: all that a cell asks before it reads one.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "format/source/mesh.h"
#include "lattice/hash128.h"
#include "worker/instance_bounds.h"
#include "worker/tiles/tile_file.h"

namespace gigabake {

struct TileCluster {
  LocalBounds bounds;
  std::shared_ptr<const Primitive> mesh;  ///< null: in the tile's scratch file
  ScratchBytes stored = {};
};

/// A primitive of TileMesh: whole, or in clusters (worker/tiles/clusters.h).
struct TilePrimitive {
  LocalBounds bounds;  ///< of all clusters
  std::uint64_t triangles = 0;
  std::vector<TileCluster> clusters;  ///< one: whole
};

struct TileImage {
  Hash128 hash;                     ///< of the encoded bytes: tiles that share an image share its textures
  std::uint64_t texture_bytes = 0;  ///< ImageSize::texture_bytes(); 0 where the bytes say nothing sensible
  EncodedImage encoded;             ///< without bytes where they are in the tile's scratch file
  ScratchBytes stored = {};
};

/// A tile without the triangles of its primitives.
struct TileDirectory {
  TileMesh mesh;  ///< its primitives keep `material` and `position_step`; no images
  std::vector<TilePrimitive> primitives;
  std::vector<TileImage> images;  ///< as TileMesh::images were
};

TileImage tile_image(EncodedImage&& encoded);

/// Clusters' meshes and images' bytes are left out.
std::vector<std::uint8_t> to_bytes(const TileDirectory& directory);
/// Errors  InputError: malformed, or an index beyond its list.
TileDirectory directory_from_bytes(std::span<const std::uint8_t> bytes);

}  // namespace gigabake
