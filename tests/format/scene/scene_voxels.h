/// What a scene's shards hold, to compare exports with.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>

#include "tests/format/shard/made_shard.h"

namespace gigabake::made {

struct VoxelBytes {
  std::array<std::uint8_t, 4> rgba{};
  std::array<std::int8_t, 2> normal{};
  friend bool operator==(const VoxelBytes&, const VoxelBytes&) = default;
};
/// By place on the level's lattice, rounded down where a level stands off it.
using SceneVoxels = std::map<std::array<std::int64_t, 3>, VoxelBytes>;

/// One level, voxel by voxel.
SceneVoxels voxels_of_scene(const std::filesystem::path& scene_xml, int lod);

/// A scene of several cells that touch, of random shards whose coarse levels stand off the blocks of 8³ voxels.
SceneDescription write_random_scene(const std::filesystem::path& scene_xml, std::mt19937_64& rng, bool normals);

}  // namespace gigabake::made
