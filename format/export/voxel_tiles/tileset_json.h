/// The JSON documents of a voxel tileset, without its tiles and subtrees.
#pragma once

#include <cstdint>
#include <string>

#include "core/math/box3.h"
#include "format/export/voxel_grid.h"
#include "format/export/voxel_tiles/implicit_octree.h"
#include "format/export/voxel_tiles/voxel_tiling.h"

namespace gigabake {

/// A summary of all tiles of a tileset.
struct TilesetSummary {
  std::uint64_t tiles = 0;
  VoxelStatistics voxels;  ///< statistics of the voxels of all levels
  Box3i64 bounds;          ///< bounds of the finest level's bricks, voxels of level 0
};

/// Returns tileset.json: 3D Tiles 1.1 with 3DTILES_content_voxels.
std::string tileset_json(const SceneHeader& scene, const VoxelTiling& tiling, const TilesetSummary& summary);

/// Returns tileset.gltf: glTF 2.1 with 3DTILES_tileset_voxels. The property asset.extras has the scene's position on
/// the earth.
std::string tileset_gltf(const SceneHeader& scene, const VoxelTiling& tiling, const TilesetSummary& summary);

}  // namespace gigabake
