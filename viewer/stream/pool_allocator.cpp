#include "viewer/stream/pool_allocator.h"

#include <algorithm>
#include <utility>

namespace gigabake {
namespace {

using kernels::CastNode;
using kernels::empty_ref;
using kernels::lost_ref;
using kernels::not_resident_ref;

/// The min number of entries of a segment, except of the only one. An eviction examines one segment.
constexpr std::uint32_t min_segment = 1 << 16;
/// The inverse of the max fraction of a segment that is evicted at once: of the only segment, and of one of many. A
/// pool of many segments replaces a quarter of its entries before it examines the same segment again.
constexpr std::uint32_t parts_of_pool = 16, parts_of_segment = 4;

std::uint32_t segments_of(std::uint32_t entries) { return std::max(entries / min_segment, 1u); }

std::size_t max_evicted(std::uint32_t examined, std::size_t all) {
  return 1 + examined / (examined == all ? parts_of_pool : parts_of_segment);
}

std::uint32_t root_tiles(std::size_t cells) { return std::uint32_t((cells + 7) / 8); }

std::uint32_t last_use(std::uint32_t touch, std::uint32_t born) { return std::max(touch, born); }

/// Returns the value of child `c` before any of its data is resident. `finest` is true if it is of level 0. Leaves
/// never become resident: the coarser brick that contains them replaces them.
CastNode new_node(const ChildMasks& children, std::uint32_t c, bool finest) {
  if ((children.stored >> c & 1) != 0) return {finest ? empty_ref : not_resident_ref, not_resident_ref};
  if ((children.leaves >> c & 1) != 0) return {lost_ref, lost_ref};
  return {empty_ref, empty_ref};
}

}  // namespace

PoolAllocator::PoolAllocator(std::size_t cells, int lods, const kernels::PoolSizes& sizes)
    : cells_(cells),
      lods_(lods),
      roots_stay_(cells < sizes.slots / 2),
      nodes_(std::size_t(8) * sizes.tiles),
      is_changed_(nodes_.size()),
      tiles_(sizes.tiles),
      slots_(sizes.slots),
      slots_per_segment_(sizes.slots / segments_of(sizes.slots)),
      tiles_per_part_((sizes.tiles + segments_of(sizes.tiles) - 1) / segments_of(sizes.tiles)) {
  for (std::uint32_t t = 0; t < root_tiles(cells); ++t) tiles_[t].used = true;
  for (std::uint32_t t = sizes.tiles; t-- > root_tiles(cells);) free_tiles_.push_back(t);
  std::vector<std::uint32_t> free_slots;
  for (std::uint32_t s = slots_per_segment_; s-- > 0;) free_slots.push_back(s);
  const std::uint32_t segments = segments_of(sizes.slots);
  segments_.assign(segments, {VoxelArena(slots_per_segment_, sizes.voxels / segments), free_slots});
}

kernels::PoolSizes PoolAllocator::in_use() const {
  kernels::PoolSizes sizes{std::uint32_t(tiles_.size() - free_tiles_.size()), 0, 0};
  for (const Segment& segment : segments_) {
    sizes.slots += slots_per_segment_ - std::uint32_t(segment.free_slots.size());
    sizes.voxels += segment.arena.size() - segment.arena.free();
  }
  return sizes;
}

std::uint32_t PoolAllocator::min_tiles(std::size_t cells, int lods) {
  // To find a surface, a ray samples points on both sides of it. These points may lie in different bricks of two
  // levels.
  constexpr std::uint32_t ways_down = 4;
  return root_tiles(cells) + ways_down * std::uint32_t(lods);
}

FieldNode PoolAllocator::place_of(std::uint32_t node) const {
  if (node < cells_) return {node, lods_ - 1, {0, 0, 0}};
  return tiles_[node / 8].place.child(node % 8);
}

bool PoolAllocator::is_settled(std::uint32_t node, std::uint32_t round) const {
  const Tile& tile = tiles_[node / 8];
  return tile.used && (node < cells_ || tile.round <= round);
}

void PoolAllocator::begin_round(std::uint32_t pass, std::uint32_t used_since, bool may_evict_used) {
  ++round_;
  pass_ = pass;
  used_since_ = used_since;
  may_evict_used_ = may_evict_used;
  evicted_used_ = false;
  slot_used_ = tile_used_ = nullptr;
}

void PoolAllocator::change(std::uint32_t node, const CastNode& value) {
  nodes_[node] = value;
  if (is_changed_[node]) return;
  is_changed_[node] = true;
  changed_.push_back(node);
}

std::vector<kernels::NodeChange> PoolAllocator::take_changes() {
  std::vector<kernels::NodeChange> changes;
  changes.reserve(changed_.size());
  for (const std::uint32_t node : changed_) {
    changes.push_back({node, nodes_[node]});
    is_changed_[node] = false;
  }
  changed_.clear();
  return changes;
}

bool PoolAllocator::put_children(std::uint32_t node, const ChildMasks& children, kernels::Caster& caster) {
  if (children.stored == 0 && children.leaves != 0) {  // needs no tile
    set_lost(node, kernels::RequestKind::children);
    return true;
  }
  if (free_tiles_.empty() && !free_some_tiles(node / 8, caster)) return false;
  const std::uint32_t t = free_tiles_.back();
  free_tiles_.pop_back();
  tiles_[t] = {node, place_of(node), pass_, round_, 0, 0, true};
  if (node >= cells_) ++tiles_[node / 8].resident_children;
  const bool finest = tiles_[t].place.lod == 1;
  for (std::uint32_t c = 0; c < 8; ++c) change(8 * t + c, new_node(children, c, finest));
  change(node, {t, nodes_[node].brick});
  return true;
}

std::optional<std::uint32_t> PoolAllocator::put_brick(std::uint32_t node, std::uint32_t parts,
                                                      kernels::Caster& caster) {
  if (!segments_[current_].fits(parts) && !advance_to_segment_for(parts, caster)) return {};
  Segment& segment = segments_[current_];
  const std::uint32_t in_segment = segment.free_slots.back(), s = slots_per_segment_ * current_ + in_segment;
  segment.free_slots.pop_back();
  slots_[s] = {node, pass_, round_, true};
  tiles_[node / 8].brick_round = round_;
  segment.arena.take(in_segment, parts);
  change(node, {nodes_[node].children, s});
  return s;
}

void PoolAllocator::set_empty(std::uint32_t node) { change(node, {nodes_[node].children, empty_ref}); }

void PoolAllocator::set_lost(std::uint32_t node, kernels::RequestKind what) {
  CastNode value = nodes_[node];
  (what == kernels::RequestKind::brick ? value.brick : value.children) = lost_ref;
  change(node, value);
}

void PoolAllocator::release_slot(std::uint32_t slot) {
  change(slots_[slot].owner, {nodes_[slots_[slot].owner].children, not_resident_ref});
  slots_[slot].used = false;
  Segment& segment = segments_[slot / slots_per_segment_];
  segment.arena.give_back(slot % slots_per_segment_);
  segment.free_slots.push_back(slot % slots_per_segment_);
}

void PoolAllocator::release_tile(std::uint32_t tile) {
  for (std::uint32_t n = 8 * tile; n < 8 * tile + 8; ++n)
    if (kernels::is_resident(nodes_[n].brick)) release_slot(nodes_[n].brick);
  const std::uint32_t parent = tiles_[tile].parent;
  change(parent, {not_resident_ref, nodes_[parent].brick});
  if (parent >= cells_) --tiles_[parent / 8].resident_children;
  tiles_[tile].used = false;
  free_tiles_.push_back(tile);
}

std::vector<std::uint32_t> PoolAllocator::nodes_in_use() const {
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t n = 0; n < nodes_.size(); ++n)
    if (tiles_[n / 8].used && (n < cells_ || n / 8 >= root_tiles(cells_))) nodes.push_back(n);
  const auto lod = [this](std::uint32_t n) { return n < cells_ ? lods_ - 1 : tiles_[n / 8].place.lod - 1; };
  std::stable_sort(nodes.begin(), nodes.end(), [&](std::uint32_t a, std::uint32_t b) { return lod(a) > lod(b); });
  return nodes;
}

void PoolAllocator::forget_brick(std::uint32_t node) {
  if (kernels::is_resident(nodes_[node].brick)) release_slot(nodes_[node].brick);
  if (nodes_[node].brick != not_resident_ref) change(node, {nodes_[node].children, not_resident_ref});
}

void PoolAllocator::forget_children(std::uint32_t node) {
  const std::uint32_t tile = nodes_[node].children;
  if (kernels::is_resident(tile)) {
    for (std::uint32_t n = 8 * tile; n < 8 * tile + 8; ++n)
      if (kernels::is_resident(nodes_[n].children)) forget_children(n);
    release_tile(tile);
  } else if (tile == lost_ref) {
    change(node, {not_resident_ref, nodes_[node].brick});
  }
}

void PoolAllocator::set_children(std::uint32_t node, const ChildMasks& children) {
  const std::uint32_t tile = nodes_[node].children;
  const bool finest = tiles_[tile].place.lod == 1;
  for (std::uint32_t c = 0; c < 8; ++c) {
    const std::uint32_t child = 8 * tile + c;
    const CastNode value = new_node(children, c, finest);
    const bool is_stored = value.brick == not_resident_ref, was_lost = nodes_[child].brick == lost_ref,
               was_stored = !was_lost && (nodes_[child].children != empty_ref || nodes_[child].brick != empty_ref);
    if (is_stored && was_stored) continue;
    if (was_stored) {
      forget_children(child);
      forget_brick(child);
    }
    change(child, value);
  }
}

/// Returns the indices of up to `maximum` candidates that were used least recently. A candidate is a pair of last use
/// and index. Omits candidates that must stay; if all must stay and `may_evict_used` is true, returns the oldest.
std::vector<std::uint32_t> PoolAllocator::oldest(Candidates candidates, std::size_t maximum, bool may_evict_used) {
  if (candidates.size() > maximum) {
    std::nth_element(candidates.begin(), candidates.begin() + std::ptrdiff_t(maximum), candidates.end());
    candidates.resize(maximum);
  }
  std::vector<std::uint32_t> gone;
  for (const auto& [touch, who] : candidates)
    if (touch < used_since_) gone.push_back(who);
  if (gone.empty() && may_evict_used && !candidates.empty()) {
    evicted_used_ = true;
    gone.push_back(std::ranges::min_element(candidates)->second);
  }
  return gone;
}

/// Calls evict(part, may_evict_used) for the `count` parts of a pool in turn, from part `first` on, until one returns
/// true. Used entries may be evicted only after all parts have failed without them. Returns false if all parts fail.
template <class Evict>
bool PoolAllocator::evict_in_turn(std::uint32_t first, std::uint32_t count, const Evict& evict) const {
  for (const bool may_evict_used : {false, true}) {
    if (may_evict_used && !may_evict_used_) break;
    for (std::uint32_t i = 0; i < count; ++i)
      if (evict((first + i) % count, may_evict_used)) return true;
  }
  return false;
}

/// Evicts tiles and the bricks of their nodes; returns false if no tile is free afterwards. Does not evict the tile
/// `stays`, which contains the node whose children are allocated.
bool PoolAllocator::free_some_tiles(std::uint32_t stays, kernels::Caster& caster) {
  const auto parts = std::uint32_t((tiles_.size() + tiles_per_part_ - 1) / tiles_per_part_);
  return evict_in_turn(tile_part_, parts, [&](std::uint32_t part, bool may_evict_used) {
    tile_part_ = (part + 1) % parts;
    return free_tiles_of(part, stays, may_evict_used, caster);
  });
}

bool PoolAllocator::free_tiles_of(std::uint32_t part, std::uint32_t stays, bool may_evict_used,
                                  kernels::Caster& caster) {
  if (tile_used_ == nullptr) tile_used_ = &caster.tile_timestamps();
  const std::uint32_t begin = part * tiles_per_part_,
                      end = std::min(begin + tiles_per_part_, std::uint32_t(tiles_.size()));
  Candidates candidates;
  for (std::uint32_t t = std::max(begin, root_tiles(cells_)); t < end; ++t)
    if (tiles_[t].used && tiles_[t].resident_children == 0 && tiles_[t].round != round_ &&
        tiles_[t].brick_round != round_ && t != stays)
      candidates.emplace_back(last_use((*tile_used_)[t], tiles_[t].born), t);
  const std::size_t maximum = max_evicted(tiles_per_part_, tiles_.size());
  for (const std::uint32_t t : oldest(std::move(candidates), maximum, may_evict_used)) release_tile(t);
  return !free_tiles_.empty();
}

/// Makes a segment the current one in which a brick fits, the next segment if possible. Returns false if no segment can
/// be made to fit the brick.
bool PoolAllocator::advance_to_segment_for(std::uint32_t parts, kernels::Caster& caster) {
  return evict_in_turn(after(current_), std::uint32_t(segments_.size()),
                       [&](std::uint32_t segment, bool may_evict_used) {
                         if (!make_fit(segment, parts, may_evict_used, caster)) return false;
                         current_ = segment;
                         return true;
                       });
}

/// Evicts bricks of the segment and moves others within it until a brick fits. Returns false if it cannot fit.
bool PoolAllocator::make_fit(std::uint32_t segment, std::uint32_t parts, bool may_evict_used, kernels::Caster& caster) {
  while (!segments_[segment].fits_after_moves(parts))
    if (!free_some_slots(segment, may_evict_used, caster)) return false;
  if (!segments_[segment].fits(parts)) close_gaps(segment, caster);
  return true;
}

bool PoolAllocator::free_some_slots(std::uint32_t segment, bool may_evict_used, kernels::Caster& caster) {
  if (slot_used_ == nullptr) slot_used_ = &caster.slot_timestamps();
  Candidates candidates;
  for (std::uint32_t s = slots_per_segment_ * segment; s < slots_per_segment_ * (segment + 1); ++s)
    if (slots_[s].used && slots_[s].round != round_ && !(roots_stay_ && slots_[s].owner < cells_))
      candidates.emplace_back(last_use((*slot_used_)[s], slots_[s].born), s);
  const std::size_t maximum = max_evicted(slots_per_segment_, slots_.size());
  const std::vector<std::uint32_t> gone = oldest(std::move(candidates), maximum, may_evict_used);
  for (const std::uint32_t s : gone) release_slot(s);
  return !gone.empty();
}

void PoolAllocator::close_gaps(std::uint32_t segment, kernels::Caster& caster) {
  std::vector<kernels::VoxelMove> moves = segments_[segment].arena.close_gaps();
  const std::uint32_t first = first_voxel(segment);
  for (kernels::VoxelMove& move : moves)
    move = {slots_per_segment_ * segment + move.slot, first + move.from, first + move.to, move.count};
  caster.move_voxels(moves);
}

}  // namespace gigabake
