/// First-hit tree (kernels/first_hit/first_hit.h) of one level of one shard.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "format/scene/paged_scene.h"
#include "format/shard/shard_reader.h"
#include "viewer/query/first_hit_scene.h"
#include "viewer/query/query_ray.h"

namespace gigabake {

/// An open shard, and the memory that the tree of one of its levels requires.
class QueryTreeSource {
 public:
  /// Opens the shard. lod: level of the lattice; the shard must have it.
  /// Errors  InputError: no such file, not a shard, not the shard that the scene lists, damaged nodes.
  QueryTreeSource(const PagedScene& scene, const SceneCell& shard, int lod);

  /// Returns the memory required while the tree is built; the finished tree is smaller.
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
  /// Builds the tree.
  /// Errors  InputError: a damaged level; columns of different lengths.
  explicit QueryTree(const QueryTreeSource& source);

  std::uint64_t bytes() const { return scene_.bytes(); }

  /// Returns the first voxel hit between two distances.
  /// Voxels are slightly enlarged about the middle of the shard's window, so that no ray slips between two shards. At
  /// the window's faces they grow by 2^-19 of the tree's edge: 1/128 voxel in a window of 1024, 1/32 in the largest.
  /// Exact   The voxel: to an error of half that growth in the position along the ray. The distance: in double, to the
  ///         entry of the ray into that voxel.
  std::optional<QueryHit> first_hit(const QueryRay& ray, double from, double to, std::uint32_t shard) const;

 private:
  std::int64_t corner_[3];  ///< of the window, lod-0 voxels of the lattice
  double unit_;             ///< edge of a voxel of the shard's own level 0, lod-0 voxels
  double half_window_;      ///< in units of `unit_`
  double grown_ = 1;        ///< enlargement factor of the voxels
  kernels::VoxelBox window_{};
  std::int32_t lod_;
  FirstHitScene scene_;  ///< in units of `unit_`, from the window's corner
};

}  // namespace gigabake
