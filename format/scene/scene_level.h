/// One level of a scene, brick by brick, as exports need it: dense bricks, constant nodes written out.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>

#include "format/scene/paged_scene.h"
#include "format/shard/shard.h"
#include "lattice/progress.h"

namespace gigabake {

/// Place of a voxel, or of a brick's lowest voxel, on the lattice of its level: voxels of 2^lod from the lattice's
/// 0,0,0.
using LevelIndex = std::array<std::int64_t, 3>;

/// Voxel (x, y, z) is bit x + 8y of mask[z] and element x + 8y + 64z.
struct DenseBrick {
  std::array<std::uint64_t, 8> mask{};
  std::array<std::array<std::uint8_t, 4>, brick_voxels> rgba{};   ///< zero where there is no voxel
  std::array<std::array<std::int8_t, 2>, brick_voxels> normal{};  ///< zero there, and where the shard has no normals

  bool has(std::size_t voxel) const { return (mask[voxel >> 6] >> (voxel & 63) & 1) != 0; }
  void set(std::size_t voxel, const std::uint8_t* colour, const std::int8_t* oct);
};

using VisitBrick = std::function<void(const LevelIndex& lowest, const DenseBrick& brick)>;

/// Each brick of one shard's level once, in the nodes' order; those that stand for a larger constant node too.
/// `lowest` is rounded down where the cell's coarse levels stand off the lattice.
void for_each_dense_brick(const ShardHeader& header, const NodeTable& nodes, const BrickLevel& level, int lod,
                          const VisitBrick& visit);

/// A level of a shard.
struct ReadLevel {
  ShardHeader header;
  NodeTable nodes;
  BrickLevel level;
};

/// Reads a level of the scene from one of its shards. lod: of the scene.
/// Errors  InputError: a shard that is missing, damaged or not the scene's, or whose voxels do not have the content
/// hash
///         that scene.xml says.
ReadLevel read_level(const PagedScene& scene, const SceneCell& shard, int lod);

/// Visits the shards that a level consists of: cells, or overviews for the levels above the cells'.
void for_each_shard_of_level(const PagedScene& scene, int lod, const PagedScene::VisitCell& visit);

/// The voxels of a scene's level, from its totals.
/// Errors  InputError: there is no such level, or not everywhere; names those that there are.
std::uint64_t voxels_of_level(const PagedScene& scene, int lod);

/// A scene, and how many voxels one of its levels has.
struct SceneLevel {
  PagedScene scene;
  std::uint64_t voxels = 0;
};

/// What an export of a level begins with. Errors  InputError: scene.xml cannot be read; voxels_of_level().
SceneLevel open_scene_level(const std::filesystem::path& scene_xml, int lod);

/// Shard by shard; advances by voxels. Cost  One page of the scene and one level of one shard in memory.
/// Errors  InputError: read_level(). Stopped.
void for_each_dense_brick(const PagedScene& scene, int lod, const VisitBrick& visit, const Progress& progress = {});

/// The same voxels cut along the lattice's own blocks of 8³ voxels: `lowest` is a multiple of 8 on each axis. A block
/// that several bricks reach into is visited once for each, with other voxels every time.
void for_each_block_part(const PagedScene& scene, int lod, const VisitBrick& visit, const Progress& progress = {});

}  // namespace gigabake
