/// Directory of a tile's scratch file: everything that a cell needs before it reads a cluster.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/io/hash128.h"
#include "format/source/mesh.h"
#include "worker/scan/instance_bounds.h"
#include "worker/tiles/tile_file.h"

namespace gigabake {

struct TileCluster {
  LocalBounds bounds;
  std::shared_ptr<const Primitive> mesh;  ///< null if it is in the tile's scratch file
  ScratchBytes stored = {};
};

/// A primitive of TileMesh, whole or in clusters (worker/tiles/clusters.h).
struct TilePrimitive {
  LocalBounds bounds;  ///< bounds of all clusters
  std::uint64_t triangles = 0;
  std::vector<TileCluster> clusters;  ///< a single cluster is the whole primitive
};

struct TileImage {
  Hash128 hash;                     ///< hash of the encoded bytes: tiles with equal images share textures
  std::uint64_t texture_bytes = 0;  ///< ImageSize::texture_bytes(); 0 if the image header is invalid
  EncodedImage encoded;             ///< without bytes if they are in the tile's scratch file
  ScratchBytes stored = {};
};

/// A tile without the triangles of its primitives.
struct TileDirectory {
  TileMesh mesh;  ///< its primitives are without_lists(); it has no images
  std::vector<TilePrimitive> primitives;
  std::vector<TileImage> images;  ///< in the order of TileMesh::images
};

TileImage tile_image(EncodedImage&& encoded);

/// Serializes the directory without the clusters' meshes and the images' bytes.
std::vector<std::uint8_t> to_bytes(const TileDirectory& directory);
/// Returns the directory that to_bytes() serialized.
/// Errors  InputError if the bytes are malformed or an index is out of range.
TileDirectory directory_from_bytes(std::span<const std::uint8_t> bytes);

}  // namespace gigabake
