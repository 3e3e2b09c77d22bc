/// LRU allocator of the ray caster's node and brick pools. Large pools consist of segments. New entries fill one
/// segment after another, and an eviction selects the least recently used entries of the next segment. Its time
/// therefore does not grow with the pool (decision 612).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "kernels/render/caster.h"
#include "viewer/stream/brick_fill.h"
#include "viewer/stream/voxel_arena.h"

namespace gigabake {

class PoolAllocator {
 public:
  /// Creates empty pools. The roots of `cells` trees of `lods` levels occupy the first tiles permanently.
  PoolAllocator(std::size_t cells, int lods, const kernels::PoolSizes& sizes);

  /// Returns the minimum number of tiles with which every ray can advance. These tiles contain the roots and the paths
  /// to all nodes that a ray uses at the same time.
  static std::uint32_t min_tiles(std::size_t cells, int lods);

  /// Returns whether the bricks of all roots take less than half of the slots. In this case root bricks are never
  /// evicted.
  bool roots_stay() const { return roots_stay_; }

  /// Returns the numbers of tiles, slots and places of the voxel pool that are in use.
  kernels::PoolSizes in_use() const;
  const kernels::CastNode& node(std::uint32_t node) const { return nodes_[node]; }
  FieldNode place_of(std::uint32_t node) const;
  /// Returns whether the node's tile is in use and was allocated in round `round` or before. An answer that was made
  /// after this round then belongs to the node. Tiles of roots count as allocated before.
  bool is_settled(std::uint32_t node, std::uint32_t round) const;
  std::uint32_t round() const { return round_; }

  /// Begins a round. Entries that are allocated from now on, and the tiles of their nodes, stay until the next round.
  /// They count as used in pass `pass`. Entries that rays used in pass `used_since` or later stay too, unless
  /// `may_evict_used` is true and nothing else can be evicted.
  void begin_round(std::uint32_t pass, std::uint32_t used_since, bool may_evict_used);
  /// Returns whether this round evicted an entry that rays used in pass `used_since` of begin_round() or later.
  bool evicted_used() const { return evicted_used_; }

  /// Returns whether a tile of children or a brick of `parts` parts can be allocated without evictions and moves, hence
  /// without the caster.
  bool has_room(std::uint32_t parts) const {
    return !free_tiles_.empty() && (segments_[current_].fits(parts) || segments_[after(current_)].fits(parts));
  }
  /// Allocates the tile of the node's children; returns false if the pool is full and nothing can be evicted. `caster`
  /// supplies the usage timestamps for eviction.
  bool put_children(std::uint32_t node, const ChildMasks& children, kernels::Caster& caster);
  /// Allocates a slot for a brick of `parts` parts; nullopt if the pools are full and nothing can be evicted. May move
  /// bricks in the voxel pool.
  std::optional<std::uint32_t> put_brick(std::uint32_t node, std::uint32_t parts, kernels::Caster& caster);
  /// Returns the current place of an allocated brick.
  kernels::BrickPlace brick_place(std::uint32_t slot) const {
    const std::uint32_t segment = slot / slots_per_segment_;
    return {slot, first_voxel(segment) + segments_[segment].arena.first(slot % slots_per_segment_)};
  }

  void set_empty(std::uint32_t node);
  void set_lost(std::uint32_t node, kernels::RequestKind what);

  /// Returns the nodes of all tiles in use, the coarsest first.
  std::vector<std::uint32_t> nodes_in_use() const;
  /// Returns whether the node's tile is in use.
  bool is_in_use(std::uint32_t node) const { return tiles_[node / 8].used; }
  /// Makes the node's brick not resident, also if it was empty or lost.
  void forget_brick(std::uint32_t node);
  /// Makes the node's children and all nodes below them not resident.
  void forget_children(std::uint32_t node);
  /// Changes which children of a node with a tile exist. A child that appears is not resident.
  void set_children(std::uint32_t node, const ChildMasks& children);

  /// Returns the changed nodes for the caster, each once with its current value, and clears the list.
  std::vector<kernels::NodeChange> take_changes();

 private:
  struct Tile {
    std::uint32_t parent = 0;  ///< node whose children the tile contains
    FieldNode place;           ///< position of the parent node
    std::uint32_t born = 0;    ///< pass of the allocation
    std::uint32_t round = 0;
    std::uint32_t brick_round = 0;        ///< round in which one of its nodes received a brick
    std::uint32_t resident_children = 0;  ///< number of the tile's nodes that have a tile of children
    bool used = false;
  };
  struct Slot {
    std::uint32_t owner = 0;  ///< node of the brick
    std::uint32_t born = 0, round = 0;
    bool used = false;
  };
  /// Slots of the pool and a part of the voxel pool, in which their bricks are stored. Numbers are relative to it.
  struct Segment {
    VoxelArena arena;
    std::vector<std::uint32_t> free_slots;

    /// Returns whether a brick can be allocated without moving others.
    bool fits(std::uint32_t parts) const { return !free_slots.empty() && arena.has_room(parts); }
    bool fits_after_moves(std::uint32_t parts) const { return !free_slots.empty() && arena.free() >= parts; }
  };
  using Candidates = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

  std::uint32_t after(std::uint32_t segment) const { return (segment + 1) % std::uint32_t(segments_.size()); }
  /// Returns the first place of the voxel pool that belongs to the segment. All segments have the same size.
  std::uint32_t first_voxel(std::uint32_t segment) const { return segments_[segment].arena.size() * segment; }
  void change(std::uint32_t node, const kernels::CastNode& value);
  template <class Evict>
  bool evict_in_turn(std::uint32_t first, std::uint32_t count, const Evict& evict) const;
  bool free_some_tiles(std::uint32_t stays, kernels::Caster& caster);
  bool free_tiles_of(std::uint32_t part, std::uint32_t stays, bool may_evict_used, kernels::Caster& caster);
  bool advance_to_segment_for(std::uint32_t parts, kernels::Caster& caster);
  bool make_fit(std::uint32_t segment, std::uint32_t parts, bool may_evict_used, kernels::Caster& caster);
  bool free_some_slots(std::uint32_t segment, bool may_evict_used, kernels::Caster& caster);
  void close_gaps(std::uint32_t segment, kernels::Caster& caster);
  void release_tile(std::uint32_t tile);
  void release_slot(std::uint32_t slot);
  std::vector<std::uint32_t> oldest(Candidates candidates, std::size_t maximum, bool may_evict_used);

  std::size_t cells_;
  std::int32_t lods_;
  bool roots_stay_;
  std::vector<kernels::CastNode> nodes_;
  std::vector<bool> is_changed_;  ///< by node: the node is in changed_
  std::vector<Tile> tiles_;
  std::vector<Slot> slots_;
  std::uint32_t slots_per_segment_;
  std::vector<Segment> segments_;
  std::uint32_t current_ = 0;                     ///< segment of new bricks
  std::uint32_t tiles_per_part_, tile_part_ = 0;  ///< parts from which tiles are evicted in turn; the next part
  std::vector<std::uint32_t> free_tiles_;
  std::vector<std::uint32_t> changed_;  ///< nodes for take_changes()
  std::uint32_t round_ = 0, pass_ = 0, used_since_ = 0;
  bool may_evict_used_ = false, evicted_used_ = false;
  /// The usage timestamps of slots and tiles; null: not read in this round yet.
  const std::vector<std::uint32_t>*slot_used_ = nullptr, *tile_used_ = nullptr;
};

}  // namespace gigabake
