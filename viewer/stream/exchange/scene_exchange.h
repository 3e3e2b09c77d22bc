/// The exchange of a part of a scene in the ray caster's pools. New contents of the nodes in the changed boxes are
/// prepared next to the pools and entered at once, so that no image shows a hole or both states.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/render/caster.h"
#include "viewer/light/shading.h"
#include "viewer/stream/brick_fill.h"
#include "viewer/stream/pool_allocator.h"
#include "viewer/stream/shard_map.h"

namespace gigabake {

/// The maximum number of nodes whose contents are prepared. If more nodes change, only the coarsest are; finer contents
/// are requested after the exchange.
inline constexpr std::size_t max_exchanged_nodes = 1024;
/// The maximum number of changed boxes; more boxes are replaced by their hull.
inline constexpr std::size_t max_changed_boxes = 64;

class SceneExchange {
 public:
  /// `changed` are the boxes in which voxels differ, lod-0 voxels. `allocator` and `layout` must outlive this object.
  SceneExchange(ShardMap next, std::vector<Box3i64> changed, PoolAllocator& allocator, const CellLayout& layout);

  /// Prepares contents whose pages are resident, until `enough` returns true but at least one batch. Appends missing
  /// pages to `missing`. Returns whether all contents are prepared.
  bool prepare(const Pager& pager, const Shading& shading, const ThreadPool& policy, const kernels::StopAsked& enough,
               std::vector<PageKey>& missing);

  /// Enters the contents into the pools. Contents of changed nodes that became resident since the start are dropped.
  /// Returns the number of entered bricks and node tiles.
  std::uint64_t enter(kernels::Caster& caster);

  /// Returns the map of the new shards; call it after enter().
  ShardMap take_map() { return std::move(map_); }

 private:
  struct Prepared {
    std::uint32_t node = 0;
    FieldNode place;
    bool has_brick = false, has_children = false;  ///< parts to prepare
    bool is_ready = false, is_empty = false, is_brick_lost = false, are_children_lost = false;
    ChildMasks children;
    kernels::CastBrick brick = {};
  };

  bool is_changed(const FieldNode& place) const;
  void prepare(Prepared& item, const VoxelLookup& lookup, const Shading& shading, std::vector<PageKey>& missing) const;
  Prepared* find(std::uint32_t node);
  void enter(Prepared& item, kernels::Caster& caster);
  void enter_brick(Prepared& item, kernels::Caster& caster);

  ShardMap map_;  ///< of the new shards
  std::vector<Box3i64> changed_;
  PoolAllocator& allocator_;
  const CellLayout& layout_;
  std::vector<Prepared> items_;  ///< by ascending node
  std::vector<std::uint32_t> new_slots_;
  kernels::CastBricks new_bricks_;
};

}  // namespace gigabake
