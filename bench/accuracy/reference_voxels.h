/// A set of a scene's voxels, read directly from its shards. References use this set, because they must not share a
/// tree with the code that they check.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <unordered_map>
#include <unordered_set>

#include "core/math/vec3.h"
#include "format/scene/xml/scene_xml.h"
#include "format/shard/shard.h"

namespace gigabake::bench {

/// The set of the voxels of one lod.
/// Cost    64 bytes and a hash entry per brick.
class ReferenceVoxels {
 public:
  /// Reads the voxels of one lod.
  /// Errors  InputError: a shard cannot be read.
  ReferenceVoxels(const SceneDescription& scene, const std::filesystem::path& scene_path, int lod);

  /// Returns true if the voxel exists. `v` is in voxels of the lod, relative to origin().
  bool exists(const Vec3i64& v) const;
  const Vec3i64& origin() const { return origin_; }

 private:
  void add_cell(const Vec3i64& corner, const NodeTable& nodes, const BrickLevel& level, int lod);

  Vec3i64 origin_{};
  std::unordered_map<std::uint64_t, std::array<std::uint64_t, 8>> bricks_;  ///< key: coordinates in bricks
  std::map<int, std::unordered_set<std::uint64_t>> constants_;  ///< constant nodes, by number of levels above the lod
};

}  // namespace gigabake::bench
