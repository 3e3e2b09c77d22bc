/// The voxels of a scene as one lattice, read through whatever pages are here.
#pragma once

#include <array>
#include <cstdint>

#include "kernels/cast/locate.h"
#include "viewer/stream/pager.h"
#include "viewer/stream/shard_map.h"

namespace gigabake {

/// What stands at a voxel, and the box for which that holds.
struct VoxelPlace {
  enum class Kind { nothing, brick, constant, unreadable };
  Kind kind = Kind::nothing;
  kernels::VoxelBox box;
  const BrickBlock* block = nullptr;  ///< of a brick: where it is, valid until the pager's next pass
  std::size_t brick = 0;              ///< in the block
  std::array<std::uint8_t, 4> rgba{};
  std::array<std::int8_t, 2> normal{};
  Facing facing{};  ///< all three of a constant
  bool has_facing = false;
};

/// Questions may be asked from several threads at once, between two passes of the pager.
class VoxelLookup {
 public:
  /// Borrows both.
  VoxelLookup(const ShardMap& map, const Pager& pager) : map_(map), pager_(pager) {}

  /// Whether any node of level `lod` reaches into the box (lod-0 voxels). Where pages are missing the answer is of no
  /// use. What cannot be read counts: of a cell all of it, of a parent whatever lies below it, so that cells are found.
  bool is_occupied(int lod, const kernels::VoxelBox& box, PageGaps& gaps) const;

  /// v: a lod-0 voxel; the answer is of the voxel of level `lod` that holds it.
  VoxelPlace place(int lod, const std::int64_t v[3], PageGaps& gaps) const;

 private:
  const NodeRow* row(const PlacedShard& shard, std::uint32_t index, PageGaps& gaps) const;
  bool lacks_row(const PlacedShard& shard, std::uint32_t index) const;
  /// What is asked for of a shard.
  struct Question {
    int lod, holder;
    kernels::VoxelBox box;
  };
  bool any_occupied(const Question& question, PageGaps& gaps) const;
  bool is_occupied_below(const PlacedShard& shard, std::uint32_t row_index, int level, const std::int64_t corner[3],
                         const Question& question, PageGaps& gaps) const;
  bool unread_occupied(const PlacedShard& shard, const Question& question, PageGaps& gaps) const;
  VoxelPlace place_in(const PlacedShard& shard, int lod, const std::int64_t v[3], PageGaps& gaps) const;
  bool may_be_occupied(const PlacedShard& shard, const kernels::VoxelBox& box, PageGaps& gaps) const;
  void set_content(const PlacedShard& shard, const NodeRow& found, int lod, PageGaps& gaps, VoxelPlace& place) const;

  const ShardMap& map_;
  const Pager& pager_;
};

}  // namespace gigabake
