/// The documents of a voxel tileset besides its tiles.
#pragma once

#include <cstdint>
#include <string>

#include "format/export/implicit_octree.h"
#include "format/export/voxel_grid.h"
#include "format/export/voxel_tiling.h"

namespace gigabake {

/// What a tileset says of all of its tiles.
struct TilesetSummary {
  std::uint64_t tiles = 0;
  VoxelStatistics voxels;  ///< of all levels
  LatticeBox bounds;       ///< of the finest level's bricks, voxels of level 0
};

/// tileset.json, 3D Tiles 1.1 with 3DTILES_content_voxels.
std::string tileset_json(const SceneHeader& scene, const VoxelTiling& tiling, const TilesetSummary& summary);

/// tileset.gltf, glTF 2.1 with 3DTILES_tileset_voxels. Where the scene lies on the earth stands in asset.extras.
std::string tileset_gltf(const SceneHeader& scene, const VoxelTiling& tiling, const TilesetSummary& summary);

}  // namespace gigabake
