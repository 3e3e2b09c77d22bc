/// The voxels of a scene as one lattice, read from the resident pages.
#pragma once

#include <array>
#include <cstdint>

#include "kernels/marching/locate.h"
#include "viewer/stream/lookup_cache.h"
#include "viewer/stream/pager.h"
#include "viewer/stream/shard_map.h"

namespace gigabake {

/// The content of the lattice at a voxel, and the box in which it applies.
struct VoxelPlace {
  enum class Kind { nothing, brick, constant, leaf, unreadable };
  Kind kind = Kind::nothing;
  int leaf_lod = 0;  ///< of `Kind::leaf`: the coarser level whose voxels describe the requested one
  kernels::VoxelBox box;
  const Page* page = nullptr;  ///< page of the brick, valid until the pager's next pass
  std::size_t brick = 0;       ///< index in the page
  std::array<std::uint8_t, 4> rgba{};
  std::array<std::int8_t, 2> normal{};
  DirectionalCoverage directional_coverage{};  ///< rgba, normal and directional_coverage are set for `Kind::constant`
  bool has_directional_coverage = false;
  VoxelClass voxel_class = no_class;  ///< for `Kind::constant`
};

/// A lookup of voxels. Several threads may use it concurrently between two passes of the pager.
class VoxelLookup {
 public:
  /// Borrows both arguments.
  VoxelLookup(const ShardMap& map, const Pager& pager) : map_(map), pager_(pager) {}

  using Boxes = std::array<kernels::VoxelBox, 8>;

  /// Returns a mask: bit i is set if a node of level `lod` overlaps boxes[i] (lod-0 voxels). The mask is invalid if
  /// pages are missing. Unreadable data counts as occupied, so that rays reach the cells. For a cell, all of it is
  /// occupied; for an overview, all shards below it.
  std::uint8_t occupied(int lod, const Boxes& boxes, MissingPages& missing_pages) const;

  /// Returns a mask: bit i is set if leaves of coarser levels than `lod` overlap boxes[i] (lod-0 voxels). Unreadable
  /// data counts as without leaves.
  std::uint8_t leaves(int lod, const Boxes& boxes, MissingPages& missing_pages) const;

  /// Returns the content of the voxel of level `lod` that contains lod-0 voxel v.
  VoxelPlace place(int lod, const Vec3i64& v, MissingPages& missing_pages, NodePath& path) const;

 private:
  const NodeRow* row(const ShardExtent& shard, std::uint32_t index, MissingPages& missing_pages) const;
  bool lacks_row(const ShardExtent& shard, std::uint32_t index) const;
  /// A query for the boxes that nodes of a level overlap. It reads the level from one provider
  /// (ShardMap::last_provider()). `open` is the mask of the boxes that have no answer yet.
  struct Question {
    int lod, provider;
    Boxes boxes;
    unsigned open;
    bool is_for_leaves = false;  ///< requests leaves in place of nodes

    kernels::VoxelBox around() const;
    unsigned reached_by(const kernels::VoxelBox& box) const;
    Question within(const kernels::VoxelBox& box) const;
  };
  /// The following functions of type `unsigned` return a mask of boxes: bit i is for question.boxes[i].
  unsigned occupied_by_any(Question question, MissingPages& missing_pages) const;
  unsigned occupied_below(const ShardExtent& shard, std::uint32_t row_index, int level, const Vec3i64& corner,
                          const Question& question, unsigned open, MissingPages& missing_pages) const;
  unsigned unread_occupied(const ShardExtent& shard, const Question& question, unsigned open,
                           MissingPages& missing_pages) const;
  VoxelPlace place_in(const ShardExtent& shard, int lod, const Vec3i64& v, MissingPages& missing_pages,
                      NodePath& path) const;
  unsigned may_be_occupied(const ShardExtent& shard, const Question& question, MissingPages& missing_pages) const;
  void set_content(const ShardExtent& shard, const NodeRow& found, int lod, MissingPages& missing_pages,
                   VoxelPlace& place) const;

  const ShardMap& map_;
  const Pager& pager_;
};

}  // namespace gigabake
