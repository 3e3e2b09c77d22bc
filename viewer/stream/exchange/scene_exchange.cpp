#include "viewer/stream/exchange/scene_exchange.h"

#include <algorithm>
#include <mutex>
#include <utility>

namespace gigabake {
namespace {

using kernels::CastNode;

/// The distance outside a node's box, in voxels of its level, to which its contents depend on voxels. It covers the
/// border, and half a voxel of cells that are offset along z.
constexpr std::int64_t dependence = 2;
constexpr std::size_t nodes_per_batch = 256;

bool is_nonexistent(const CastNode& node) {
  return node.children == kernels::empty_ref && node.brick == kernels::empty_ref;
}

/// Returns whether the node lies in a leaf. PoolAllocator::set_children() has entered its parent's children before, so
/// other nodes whose data was lost are requested again.
bool is_in_leaf(const CastNode& node, const FieldNode& place, std::int32_t root_lod) {
  return place.lod < root_lod && node.children == kernels::lost_ref && node.brick == kernels::lost_ref;
}

std::vector<Box3i64> bounded(std::vector<Box3i64> boxes) {
  if (boxes.size() <= max_changed_boxes) return boxes;
  Box3i64 all;
  for (const Box3i64& box : boxes) all = hull(all, box);
  return {all};
}

}  // namespace

SceneExchange::SceneExchange(ShardMap next, std::vector<Box3i64> changed, PoolAllocator& allocator,
                             const CellLayout& layout)
    : map_(std::move(next)), changed_(bounded(std::move(changed))), allocator_(allocator), layout_(layout) {
  std::int32_t lod = 0;
  std::size_t coarser = 0;  // number of items above the level of the last item
  for (const std::uint32_t node : allocator.nodes_in_use()) {
    const CastNode& resident = allocator.node(node);
    const bool has_brick = resident.brick != kernels::not_resident_ref;
    const bool has_children = kernels::is_resident(resident.children);
    if (!has_brick && !has_children) continue;
    const FieldNode place = allocator.place_of(node);
    if (!is_changed(place)) continue;
    if (items_.empty() || place.lod != lod) coarser = items_.size();
    lod = place.lod;
    if (items_.size() >= max_exchanged_nodes && coarser != 0) {
      items_.resize(coarser);  // only whole levels
      break;
    }
    Prepared item;
    item.node = node;
    item.place = place;
    item.has_brick = has_brick;
    item.has_children = has_children;
    items_.push_back(std::move(item));
  }
  std::sort(items_.begin(), items_.end(), [](const Prepared& a, const Prepared& b) { return a.node < b.node; });
}

bool SceneExchange::is_changed(const FieldNode& place) const {
  const kernels::VoxelBox own = box_of(place, layout_);
  const Vec3i64 margin = Vec3i64::all(dependence << place.lod);
  const Box3i64 box{own.min - margin, own.max + margin};
  return std::any_of(changed_.begin(), changed_.end(), [&](const Box3i64& changed) { return changed.overlaps(box); });
}

void SceneExchange::prepare(Prepared& item, const VoxelLookup& lookup, const Shading& shading,
                            std::vector<PageKey>& missing) const {
  MissingPages of_brick, of_children;
  of_brick.own = of_children.own = box_of(item.place, layout_);
  if (item.has_children) item.children = children_of(item.place, layout_, lookup, of_children);
  if (item.has_brick) {
    NodePath path;
    BrickPages pages{};
    item.is_empty = !fill_brick(item.place, layout_, lookup, shading, path, of_brick, item.brick, pages);
    copy_runs(shading, pages, item.brick);
  }
  missing.insert(missing.end(), of_children.missing.begin(), of_children.missing.end());
  missing.insert(missing.end(), of_brick.missing.begin(), of_brick.missing.end());
  item.is_ready = of_children.missing.empty() && of_brick.missing.empty();
  item.are_children_lost = of_children.damaged;
  item.is_brick_lost = of_brick.damaged || (item.is_empty && of_brick.is_overview_damaged);
}

bool SceneExchange::prepare(const Pager& pager, const Shading& shading, const ThreadPool& policy,
                            const kernels::StopAsked& enough, std::vector<PageKey>& missing) {
  const VoxelLookup lookup(map_, pager);
  std::vector<Prepared*> open;
  for (Prepared& item : items_)
    if (!item.is_ready) open.push_back(&item);
  std::mutex mutex;
  for (std::size_t from = 0; from < open.size(); from += nodes_per_batch) {
    if (from != 0 && enough && enough()) return false;
    const std::size_t count = std::min(nodes_per_batch, open.size() - from);
    policy.parallel_for(count, 8, [&](std::size_t begin, std::size_t end, int) {
      std::vector<PageKey> own;
      for (std::size_t i = begin; i < end; ++i) prepare(*open[from + i], lookup, shading, own);
      const std::scoped_lock lock(mutex);
      missing.insert(missing.end(), own.begin(), own.end());
    });
  }
  return std::all_of(open.begin(), open.end(), [](const Prepared* item) { return item->is_ready; });
}

SceneExchange::Prepared* SceneExchange::find(std::uint32_t node) {
  const auto found = std::lower_bound(items_.begin(), items_.end(), node,
                                      [](const Prepared& p, std::uint32_t n) { return p.node < n; });
  if (found == items_.end() || found->node != node) return nullptr;
  const FieldNode place = allocator_.place_of(node);  // its tile may have been evicted and used for another place
  const bool is_same = place.cell == found->place.cell && place.lod == found->place.lod && place.at == found->place.at;
  return is_same ? &*found : nullptr;
}

void SceneExchange::enter_brick(Prepared& item, kernels::Caster& caster) {
  if (!item.has_brick) return allocator_.forget_brick(item.node);  // became resident since the start
  allocator_.forget_brick(item.node);
  if (item.is_brick_lost) return allocator_.set_lost(item.node, kernels::RequestKind::brick);
  if (item.is_empty) return allocator_.set_empty(item.node);
  const auto slot = allocator_.put_brick(item.node, item.brick.part_count, caster);
  if (!slot) return;  // the pool is full; the brick will be requested
  new_slots_.push_back(*slot);
  new_bricks_.push_back(std::make_unique<kernels::CastBrick>(std::move(item.brick)));
}

void SceneExchange::enter(Prepared& item, kernels::Caster& caster) {
  const bool has_tile = kernels::is_resident(allocator_.node(item.node).children);
  if (!has_tile || !item.has_children || item.are_children_lost)
    allocator_.forget_children(item.node);
  else
    allocator_.set_children(item.node, item.children);
  enter_brick(item, caster);
}

std::uint64_t SceneExchange::enter(kernels::Caster& caster) {
  allocator_.begin_round(caster.pass(), 0, true);
  const std::int32_t root_lod = layout_.scene.lods - 1;
  for (const std::uint32_t node : allocator_.nodes_in_use()) {
    // Skips nodes of released tiles, and children that do not exist.
    const FieldNode place = allocator_.place_of(node);
    if (!allocator_.is_in_use(node) || !is_changed(place)) continue;
    if (is_nonexistent(allocator_.node(node)) || is_in_leaf(allocator_.node(node), place, root_lod)) continue;
    if (Prepared* item = find(node)) {
      enter(*item, caster);
    } else {
      allocator_.forget_children(node);
      allocator_.forget_brick(node);
    }
  }
  std::vector<kernels::BrickPlace> places;
  for (const std::uint32_t slot : new_slots_) places.push_back(allocator_.brick_place(slot));
  caster.put_bricks(places, new_bricks_);
  caster.put_nodes(allocator_.take_changes());
  return new_slots_.size();
}

}  // namespace gigabake
