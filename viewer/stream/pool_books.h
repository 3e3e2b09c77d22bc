/// Who stands where in the ray caster's pools, and who goes when they are full: the longest unused.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "kernels/cast/caster.h"
#include "viewer/stream/brick_fill.h"
#include "viewer/stream/voxel_arena.h"

namespace gigabake {

class PoolBooks {
 public:
  /// The roots of `cells` cells of `lods` levels stand in the first tiles, for ever.
  PoolBooks(std::size_t cells, int lods, const kernels::PoolSizes& sizes);

  /// The least tiles with which every ray can go on: the roots', and ways down to all that it uses at a time.
  static std::uint32_t least_tiles(std::size_t cells, int lods);

  /// Whether there is room for the bricks of all roots, which then never go.
  bool roots_stay() const { return roots_stay_; }

  /// Tiles, slots and places of the pool of voxels that hold something.
  kernels::PoolSizes in_use() const {
    return {std::uint32_t(tiles_.size() - free_tiles_.size()), std::uint32_t(slots_.size() - free_slots_.size()),
            arena_.size() - arena_.free()};
  }
  const kernels::CastNode& node(std::uint32_t node) const { return nodes_[node]; }
  FieldNode place_of(std::uint32_t node) const;
  /// Whether the node's tile is in use, and was so before this round.
  bool is_settled(std::uint32_t node) const;

  /// From here on, what is taken stays until the next round. What rays used in pass `used_since` or later stays too,
  /// unless it may go where nothing else can.
  void begin_round(std::uint32_t used_since, bool may_evict_used);
  /// Whether anything went that was used.
  bool evicted_used() const { return evicted_used_; }

  /// caster: asked what the rays of the last pass used, where room must be made. False where none can be made.
  bool put_children(std::uint32_t node, std::uint8_t children, kernels::Caster& caster);
  /// A brick of so many parts: its slot. What stands in the pool of voxels may move.
  std::optional<std::uint32_t> put_brick(std::uint32_t node, std::uint32_t parts, kernels::Caster& caster);
  /// Where a brick that was put stands now.
  kernels::BrickPlace brick_place(std::uint32_t slot) const { return {slot, arena_.first(slot)}; }

  void set_empty(std::uint32_t node);
  void set_lost(std::uint32_t node, kernels::Want what);

  /// For the caster, each node once, as it is now; forgets them.
  std::vector<kernels::NodeChange> take_changes();

 private:
  struct Tile {
    std::uint32_t parent = 0;  ///< node
    FieldNode place;           ///< of the parent
    std::uint32_t born = 0;    ///< pass
    std::uint32_t round = 0;
    std::uint32_t children_here = 0;  ///< of its nodes: tiles
    bool used = false;
  };
  struct Slot {
    std::uint32_t owner = 0;  ///< node
    std::uint32_t born = 0, round = 0;
    bool used = false;
  };

  void change(std::uint32_t node, const kernels::CastNode& value);
  bool free_some_tiles(std::uint32_t stays, kernels::Caster& caster);
  bool free_some_slots(kernels::Caster& caster);
  void release_tile(std::uint32_t tile);
  void release_slot(std::uint32_t slot);
  std::vector<std::uint32_t> oldest(std::vector<std::pair<std::uint32_t, std::uint32_t>> candidates, std::size_t most);

  std::size_t cells_;
  std::int32_t lods_;
  bool roots_stay_;
  std::vector<kernels::CastNode> nodes_;
  std::vector<bool> is_changed_;  ///< by node: it stands in changed_
  std::vector<Tile> tiles_;
  std::vector<Slot> slots_;
  VoxelArena arena_;
  std::vector<std::uint32_t> free_tiles_, free_slots_;
  std::vector<std::uint32_t> changed_;  ///< nodes
  std::uint32_t round_ = 0, used_since_ = 0;
  bool may_evict_used_ = false, evicted_used_ = false;
};

}  // namespace gigabake
