/// One level of one shard as rays walk through it: the tree of first hits (kernels/cast/first_hit.h) of that shard
/// alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "format/scene/paged_scene.h"
#include "format/shard/shard_reader.h"
#include "viewer/first_hit/first_hit_scene.h"
#include "viewer/query/query_ray.h"

namespace gigabake {

/// A shard that is open, and how much a tree of one of its levels will take.
class QueryTreeSource {
 public:
  /// lod: of the lattice; the shard has it.
  /// Errors  InputError: no such file, not a shard, not the one that the scene means, damaged nodes.
  QueryTreeSource(const PagedScene& scene, const SceneCell& shard, int lod);

  /// Of memory while the tree is built; the tree itself takes less.
  std::uint64_t bytes_to_build() const;

 private:
  friend class QueryTree;
  std::filesystem::path path_;
  SceneCell shard_;
  int shard_lod_;
  ShardReader reader_;
  NodeTable nodes_;
  std::uint64_t stored_voxels_ = 0, bricks_ = 0, constants_ = 0;
};

class QueryTree {
 public:
  /// Errors  InputError: a damaged level; columns that do not fit together.
  explicit QueryTree(const QueryTreeSource& source);

  std::uint64_t bytes() const { return scene_.bytes(); }

  /// The first voxel between two distances. The shard's voxels are taken a little larger, about the middle of its
  /// window, than they are, so that no ray slips between those of two shards: at the window's faces by 2^-19 of the
  /// tree's edge, which is 1/128 voxel in a window of 1024 and 1/32 in the widest.
  /// Exact   Which voxel: to half as much more of the ray's way. distance: in double, where the ray meets that voxel.
  std::optional<QueryHit> first_hit(const QueryRay& ray, double from, double to, std::uint32_t shard) const;

 private:
  std::int64_t corner_[3];  ///< of the window, lod-0 voxels of the lattice
  double unit_;             ///< edge of a voxel of the shard's own level 0, lod-0 voxels
  double half_window_;      ///< in those units
  double grown_ = 1;        ///< how many times as large voxels are taken as they are
  kernels::VoxelBox window_{};
  std::int32_t lod_;
  FirstHitScene scene_;  ///< in those units, from the window's corner
};

}  // namespace gigabake
