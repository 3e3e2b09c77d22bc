/// Shards and scenes made for tests, and a temporary folder for them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "core/math/vec3.h"
#include "format/scene/xml/scene_xml.h"
#include "format/shard/shard.h"

namespace gigabake::made {

/// An empty folder that is removed with this object.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Returns the content of a file.
std::string bytes_of(const std::filesystem::path& path);

struct ShardShape {
  int lods = 3;
  bool normals = true;
  int max_children = 8;              ///< per node
  bool alike = false;                ///< neighbours are often equal, so that values are shared
  bool directional_coverage = true;  ///< and planes, with normals
  bool nested = false;               ///< each voxel lies in a voxel of the next coarser level, as in a bake
};

/// Returns a random consistent shard: bricks, constant and leaf-constant nodes, voxels of all colours, with
/// content_hash.
Shard random_shard(std::mt19937_64& rng, const ShardShape& shape);

/// Returns the shard with the content_hash of its voxels.
Shard with_content_hash(Shard shard);

/// Returns the shard with different classes for its voxels, and with its content_hash.
Shard with_classes(Shard shard);

/// Returns a cell of 16³ voxels whose every byte is defined in this module: the content of the golden files.
Shard small_shard();

/// Returns small_shard() with directional coverage and planes as version `version` stores them. Planes exist from
/// version 3 on; planes of lod-0 voxels from version 6 on.
Shard small_shard_with_planes(int version = 6);

/// Returns a small downsample state for small_shard(). Shards store it from version 4 on.
DownsampleState small_above();

/// Returns an overview with levels 1 and 2 above small_shard(), the finer of which is marked as duplicated. Supported
/// from version 5 on.
Shard small_overview();

/// Returns a cell of one leaf-constant root: two levels without bricks.
Shard constant_shard();

/// A lod-0 voxel for shard_of(). A list of voxels has at most one voxel per position.
struct Voxel {
  Vec3i64 at{};  ///< position on the lattice of lod 0
  std::array<std::uint8_t, 4> rgba{};
  std::array<std::int8_t, 2> normal{};
};
/// Returns the shard of these voxels, with levels up to a single brick. A coarse voxel repeats the first lod-0 voxel in
/// it. Voxels outside of the cell are left out.
Shard shard_of(const std::vector<Voxel>& voxels, Vec3i64 lattice_min, std::uint32_t cell_voxels);

/// Writes the shard of a cell or an overview next to scene.xml, as a bake does, and returns its entry in scene.xml.
SceneCell write_shard_of(const std::filesystem::path& scene_xml, const Shard& shard);
/// Writes the shards and scene.xml, and returns the content of scene.xml.
SceneDescription write_scene_of(const std::filesystem::path& scene_xml, const std::vector<Shard>& shards);

/// Returns a readable description of the first difference; empty if the shards are equal.
std::string difference(const Shard& a, const Shard& b);

}  // namespace gigabake::made
