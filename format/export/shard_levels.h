/// Cache of shard levels. A level is unpacked once for all tiles that contain its voxels.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/math/box3.h"
#include "format/export/level_owners.h"
#include "format/export/voxel_tiles/voxel_tiling.h"
#include "format/scene/scene_level.h"
#include "format/shard/levels/brick_walk.h"
#include "format/system/loading_cache.h"

namespace gigabake {

/// One level of one shard.
class ShardLevel {
 public:
  /// Errors  InputError: the shard is missing, damaged or not part of the scene.
  ShardLevel(const PagedScene& scene, const SceneCell& shard, int lod);

  /// Calls visit(position, rgba, normal, class) for each voxel in the box. Positions are in voxels of the level. They
  /// are rounded down if the shard's level is not aligned with the lattice.
  template <class Visit>
  void for_each_voxel_in(const Box3i64& box, const Visit& visit) const;
  std::uint64_t bytes() const;

 private:
  struct Constant {
    LevelIndex lowest;
    std::int64_t edge;
    std::array<std::uint8_t, 4> rgba;
    std::array<std::int8_t, 2> normal;
    VoxelClass voxel_class;
  };
  LevelIndex corner_{};
  std::vector<std::uint64_t> keys_;    ///< Morton keys of bricks
  std::vector<std::uint32_t> number_;  ///< brick numbers in level_
  std::vector<Constant> constants_;
  BrickLevel level_;
};

/// Returns the boxes of all bricks, constant nodes and octants of leaves that represent lattice level `lod`, in voxels
/// of this level. Reads only the node table.
std::vector<Box3i64> bricks_of(const ShardHeader& header, const NodeTable& nodes, int lod);

/// Cache of the most recently used levels. Thread-safe.
class ShardLevels {
 public:
  /// `max_bytes` limits the total size of the cached levels. A single level that is larger stays until the next level
  /// is read.
  ShardLevels(const PagedScene& scene, std::uint64_t max_bytes)
      : scene_(scene), max_bytes_(max_bytes), levels_(max_bytes, 1) {}

  /// Returns the level. If another thread reads it, waits for it.
  /// Errors  The errors of ShardLevel.
  std::shared_ptr<const ShardLevel> get(const SceneCell& shard, int lod);
  /// Reads the level for later calls of get(), unless it is cached or another thread reads it. Levels that take more
  /// than a quarter of the cache are not read, so that the levels in use stay. Errors are left to get().
  void read_ahead(const SceneCell& shard, int lod);

 private:
  struct Key {
    std::string file;
    int lod;
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct KeyHash {
    std::size_t operator()(const Key& key) const { return std::hash<std::string>()(key.file) + std::size_t(key.lod); }
  };

  std::shared_ptr<const ShardLevel> read(const SceneCell& shard, int lod) const;

  const PagedScene& scene_;
  std::uint64_t max_bytes_;
  LoadingCache<Key, ShardLevel, KeyHash> levels_;
};

template <class Visit>
void ShardLevel::for_each_voxel_in(const Box3i64& box, const Visit& visit) const {
  for (std::size_t b = 0; b < keys_.size(); ++b) {
    const LevelIndex low = corner_ + LevelIndex(demorton(keys_[b])) * brick_edge;
    if (!box.overlaps(Box3i64::cube(low, brick_edge))) continue;
    for_each_voxel(level_, number_[b], {},
                   [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba,
                       const std::int8_t* normal, const std::uint8_t*, VoxelClass voxel_class) {
                     const LevelIndex at{low[0] + x, low[1] + y, low[2] + z};
                     if (box.contains(at)) visit(at, rgba, normal, voxel_class);
                   });
  }
  for (const Constant& node : constants_) {
    const Box3i64 part = intersection(box, Box3i64::cube(node.lowest, node.edge));
    for (std::int64_t z = part.min[2]; z < part.end[2]; ++z)
      for (std::int64_t y = part.min[1]; y < part.end[1]; ++y)
        for (std::int64_t x = part.min[0]; x < part.end[0]; ++x)
          visit(LevelIndex{x, y, z}, node.rgba.data(), node.normal.data(), node.voxel_class);
  }
}

}  // namespace gigabake
