/// Reader of one level of a scene for exports. It visits dense bricks, and expands constant nodes to bricks.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>

#include "core/base/progress.h"
#include "core/math/vec3.h"
#include "format/scene/paged_scene.h"
#include "format/shard/shard.h"

namespace gigabake {

/// Position of a voxel, or of a brick's lowest voxel, in voxels of its level (2^lod lod-0 voxels) from lattice voxel
/// (0, 0, 0).
using LevelIndex = Vec3i64;

/// A brick with an element for each of its 512 positions. Voxel (x, y, z) is bit x + 8y of mask[z] and element x + 8y +
/// 64z.
struct DenseBrick {
  std::array<std::uint64_t, 8> mask{};
  std::array<std::array<std::uint8_t, 4>, brick_voxels> rgba{};   ///< zero where there is no voxel
  std::array<std::array<std::int8_t, 2>, brick_voxels> normal{};  ///< zero where there is no voxel or the shard has no
                                                                  ///< normals
  std::array<VoxelClass, brick_voxels> voxel_class{};             ///< no_class where there is no voxel or class

  bool has(std::size_t voxel) const { return (mask[voxel >> 6] >> (voxel & 63) & 1) != 0; }
  void set(std::size_t voxel, const std::uint8_t* colour, const std::int8_t* oct, VoxelClass of_voxel);
};

using VisitBrick = std::function<void(const LevelIndex& lowest, const DenseBrick& brick)>;

/// Visits each brick of one level of a shard once, in the nodes' order, including bricks that represent a part of a
/// larger constant node. `lowest` is rounded down if the cell's coarse levels are not aligned with the lattice.
void for_each_dense_brick(const ShardHeader& header, const NodeTable& nodes, const BrickLevel& level, int lod,
                          const VisitBrick& visit);

/// A level of a shard.
struct ReadLevel {
  ShardHeader header;
  NodeTable nodes;
  BrickLevel level;
};

/// Reads a level of the scene from one of its shards. `lod` is a level of the lattice. Leaves of coarser levels are
/// expanded (format/scene/expanded_leaves.h).
/// Errors  InputError if the shard is missing, damaged or not part of the scene, or if its voxels do not match the
///         content hash in scene.xml.
ReadLevel read_level(const PagedScene& scene, const SceneCell& shard, int lod);

/// Visits the shards that contain a level as their own level: cells, or overviews for levels above the cells' levels.
void for_each_shard_of_level(const PagedScene& scene, int lod, const PagedScene::VisitCell& visit);

/// Returns the number of voxels that a level stores, from the scene's totals.
/// Errors  InputError if the level does not exist, or exists in only some cells. The message names the existing levels.
std::uint64_t voxels_of_level(const PagedScene& scene, int lod);

/// Returns the number of voxels that describe a level: those that it stores, and those that leaves of coarser levels
/// represent on it. If the scene has such leaves, reads the coarser levels of all cells.
/// Errors  The errors of voxels_of_level(). InputError: a shard is damaged or not part of the scene.
std::uint64_t described_voxels(const PagedScene& scene, int lod);

/// A scene and the number of voxels that describe one of its levels.
struct SceneLevel {
  PagedScene scene;
  std::uint64_t voxels = 0;
};

/// Opens a scene to export one of its levels.
/// Errors  InputError if scene.xml cannot be read; the errors of described_voxels().
SceneLevel open_scene_level(const std::filesystem::path& scene_xml, int lod);

/// Visits the bricks of a level, shard by shard. `progress` advances by the number of voxels.
/// Cost    Holds one page of the scene and one level of one shard in memory.
/// Errors  The errors of voxels_of_level() and read_level(). Stopped if `progress` cancels.
void for_each_dense_brick(const PagedScene& scene, int lod, const VisitBrick& visit, const Progress& progress = {});

/// Visits the voxels of a level in blocks of 8³ voxels that are aligned to the lattice. `lowest` is a multiple of 8 on
/// each axis. A block that several bricks overlap is visited once per brick, each time with other voxels.
void for_each_block_part(const PagedScene& scene, int lod, const VisitBrick& visit, const Progress& progress = {});

}  // namespace gigabake
