/// The voxels of a scene's shards, as the reference for exports.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>

#include "core/math/vec3.h"
#include "tests/format/shard/made_shard.h"
#include "tests/random_seed.h"

namespace gigabake::made {

struct VoxelBytes {
  std::array<std::uint8_t, 4> rgba{};
  std::array<std::int8_t, 2> normal{};
  VoxelClass voxel_class = no_class;
  friend bool operator==(const VoxelBytes&, const VoxelBytes&) = default;
};
/// Voxels by their position on the lattice of a level. If the level is not aligned to the lattice, positions are
/// rounded down.
using SceneVoxels = std::map<Vec3i64, VoxelBytes>;

/// Returns the voxels of level `lod`, each read separately.
SceneVoxels voxels_of_scene(const std::filesystem::path& scene_xml, int lod);

/// Writes a scene of adjacent cells with random voxels. The coarse levels of a cell are not aligned to blocks of 8³
/// voxels.
SceneDescription write_random_scene(const std::filesystem::path& scene_xml, std::mt19937_64& rng, bool normals,
                                    bool classes = false);

/// A scene of write_random_scene() in a separate folder, for one round of a test with several rounds. Every third scene
/// has no normals, including the first. Every second scene has classes if `classes` is set, including the first. While
/// the object exists, a failure prints its seed.
class RandomScene {
 public:
  explicit RandomScene(int round, bool classes = false);

  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }
  std::filesystem::path xml() const { return folder_ / "scene.xml"; }
  const SceneDescription& description() const { return description_; }
  SceneVoxels voxels(int lod) const { return voxels_of_scene(xml(), lod); }

 private:
  test::RandomSeed seed_;
  TempFolder folder_;
  SceneDescription description_;
};

}  // namespace gigabake::made
