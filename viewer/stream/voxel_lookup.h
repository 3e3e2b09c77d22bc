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

inline constexpr std::uint32_t no_shard = 0xffffffffu;

/// The latest way down the nodes of a shard: another one starts where the two part. Of one thread, for one pass of the
/// pager.
struct NodePath {
  std::uint32_t shard = no_shard;
  std::int32_t lowest = 0;                           ///< level it ended at
  std::int64_t v[3] = {};                            ///< where it led, lod-0 voxels from the shard's corner
  const NodeRow* node[kernels::max_cast_lods] = {};  ///< by level, from `lowest` on
};

/// Questions may be asked from several threads at once, between two passes of the pager.
class VoxelLookup {
 public:
  /// Borrows both.
  VoxelLookup(const ShardMap& map, const Pager& pager) : map_(map), pager_(pager) {}

  using Boxes = std::array<kernels::VoxelBox, 8>;

  /// Into which of the boxes (lod-0 voxels) any node of level `lod` reaches: bit i says so of boxes[i]. Where pages are
  /// missing the answer is of no use. What cannot be read counts: of a cell all of it, of a parent whatever lies below
  /// it, so that cells are found.
  std::uint8_t occupied(int lod, const Boxes& boxes, PageGaps& gaps) const;

  /// v: a lod-0 voxel; the answer is of the voxel of level `lod` that holds it.
  VoxelPlace place(int lod, const std::int64_t v[3], PageGaps& gaps, NodePath& path) const;

 private:
  const NodeRow* row(const PlacedShard& shard, std::uint32_t index, PageGaps& gaps) const;
  bool lacks_row(const PlacedShard& shard, std::uint32_t index) const;
  /// What is asked for of a shard, and which of the boxes are still asked about.
  struct Question {
    int lod, holder;
    Boxes boxes;
    unsigned open;

    kernels::VoxelBox around() const;
    unsigned reached_by(const kernels::VoxelBox& box) const;
    Question within(const kernels::VoxelBox& box) const;
  };
  /// These answer with boxes, as bits.
  unsigned occupied_by_any(Question question, PageGaps& gaps) const;
  unsigned occupied_below(const PlacedShard& shard, std::uint32_t row_index, int level, const std::int64_t corner[3],
                          const Question& question, unsigned open, PageGaps& gaps) const;
  unsigned unread_occupied(const PlacedShard& shard, const Question& question, unsigned open, PageGaps& gaps) const;
  VoxelPlace place_in(const PlacedShard& shard, int lod, const std::int64_t v[3], PageGaps& gaps, NodePath& path) const;
  unsigned may_be_occupied(const PlacedShard& shard, const Question& question, PageGaps& gaps) const;
  void set_content(const PlacedShard& shard, const NodeRow& found, int lod, PageGaps& gaps, VoxelPlace& place) const;

  const ShardMap& map_;
  const Pager& pager_;
};

}  // namespace gigabake
