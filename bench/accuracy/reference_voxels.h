/// Which voxels a scene has, straight from its shards: for references that must not share a tree with what they check.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <unordered_map>
#include <unordered_set>

#include "format/scene/scene_xml.h"
#include "format/shard/shard.h"

namespace gigabake::bench {

/// Cost    64 bytes and a hash entry a brick.
class ReferenceVoxels {
 public:
  /// lod: of the voxels. Errors  InputError: a shard that cannot be read.
  ReferenceVoxels(const SceneDescription& scene, const std::filesystem::path& scene_path, int lod);

  /// v: in voxels of the lod, from lod-0 voxel `origin` of the lattice, which is a corner of a brick.
  bool exists(const std::array<std::int64_t, 3>& v) const;
  const std::array<std::int64_t, 3>& origin() const { return origin_; }

 private:
  void add_cell(const std::array<std::int64_t, 3>& corner, const NodeTable& nodes, const BrickLevel& level, int lod);

  std::array<std::int64_t, 3> origin_{};
  std::unordered_map<std::uint64_t, std::array<std::uint64_t, 8>> bricks_;  ///< by coordinates in bricks
  std::map<int, std::unordered_set<std::uint64_t>> constants_;  ///< by levels above the lod; whole nodes of voxels
};

}  // namespace gigabake::bench
