#include "viewer/stream/voxel_lookup.h"

#include <algorithm>
#include <bit>

namespace gigabake {
namespace {

using kernels::VoxelBox;

VoxelBox node_box(const std::int64_t corner[3], int level) {
  VoxelBox box;
  for (int a = 0; a < 3; ++a) {
    box.min[a] = corner[a];
    box.max[a] = corner[a] + (std::int64_t(brick_edge) << level);
  }
  return box;
}

VoxelBox common_box(const VoxelBox& a, const VoxelBox& b) {
  VoxelBox box;
  for (int i = 0; i < 3; ++i) {
    box.min[i] = std::max(a.min[i], b.min[i]);
    box.max[i] = std::min(a.max[i], b.max[i]);
  }
  return box;
}

std::uint32_t child_row(const NodeRow& parent, int child) {
  return parent.first_child + std::uint32_t(std::popcount(parent.child_mask & ((1u << child) - 1)));
}

}  // namespace

const NodeRow* VoxelLookup::row(const PlacedShard& shard, std::uint32_t index, PageGaps& gaps) const {
  const Page* page = find_page(pager_, {shard.number, PageKey::node_rows, index / nodes_per_block}, gaps);
  return page == nullptr || index % nodes_per_block >= page->rows.size() ? nullptr
                                                                         : &page->rows[index % nodes_per_block];
}

/// The row will never be here: its page cannot be read, or has fewer rows than other rows refer to.
bool VoxelLookup::lacks_row(const PlacedShard& shard, std::uint32_t index) const {
  const PageKey key{shard.number, PageKey::node_rows, index / nodes_per_block};
  if (pager_.is_damaged(key)) return true;
  const Page* page = pager_.find(key);
  return page != nullptr && index % nodes_per_block >= page->rows.size();
}

bool VoxelLookup::is_occupied(int lod, const VoxelBox& box, PageGaps& gaps) const {
  return any_occupied({lod, 0, box}, gaps);
}

bool VoxelLookup::any_occupied(const Question& question, PageGaps& gaps) const {
  return map_.any(question.lod, question.holder, question.box, pager_, gaps, [&](const PlacedShard& shard) {
    return is_occupied_below(shard, 0, shard.top(), shard.window.min, question, gaps);
  });
}

/// The parent cannot be read. Whatever is stored below it may reach into the box.
bool VoxelLookup::may_be_occupied(const PlacedShard& shard, const VoxelBox& box, PageGaps& gaps) const {
  gaps.beside_damaged = true;
  const int below = shard.own_lod - 1;
  return map_.any(below, map_.last_holder(below), common_box(box, shard.window), pager_, gaps,
                  [](const PlacedShard&) { return true; });
}

/// The shard's nodes cannot be read. Others say it where it has copies of theirs.
bool VoxelLookup::unread_occupied(const PlacedShard& shard, const Question& question, PageGaps& gaps) const {
  if (question.holder < map_.last_holder(question.lod))
    return any_occupied({question.lod, question.holder + 1, common_box(question.box, shard.window)}, gaps);
  if (shard.is_parent()) return may_be_occupied(shard, question.box, gaps);
  gaps.damaged |= overlap(shard.window, gaps.own);
  return true;
}

/// The node of row_index is there and overlaps the box.
bool VoxelLookup::is_occupied_below(const PlacedShard& shard, std::uint32_t row_index, int level,
                                    const std::int64_t corner[3], const Question& question, PageGaps& gaps) const {
  if (level == question.lod) return true;
  const NodeRow* node = row(shard, row_index, gaps);
  if (node == nullptr) return lacks_row(shard, row_index) && unread_occupied(shard, question, gaps);
  if (node->kind == NodeKind::leaf_constant) return true;
  for (int child = 0; child < 8; ++child) {
    if ((node->child_mask >> child & 1) == 0) continue;
    std::int64_t at[3];
    for (int a = 0; a < 3; ++a) at[a] = corner[a] + (std::int64_t(child >> a & 1) << (level + 2));
    if (overlap(node_box(at, level - 1), question.box) &&
        is_occupied_below(shard, child_row(*node, child), level - 1, at, question, gaps))
      return true;
  }
  return false;
}

void VoxelLookup::set_content(const PlacedShard& shard, const NodeRow& found, int lod, PageGaps& gaps,
                              VoxelPlace& place) const {
  if (found.kind != NodeKind::brick) {
    place.kind = VoxelPlace::Kind::constant;
    for (std::size_t c = 0; c < 4; ++c) place.rgba[c] = std::uint8_t(found.value >> (8 * c));
    std::copy_n(found.normal, 2, place.normal.begin());
    std::copy_n(found.facing, facing_bytes, place.facing.begin());
    place.has_facing = lod > 0 && place.facing != Facing{};
    return;
  }
  const Page* page = find_page(pager_, {shard.number, lod - shard.first_lod, found.value / bricks_per_block}, gaps);
  if (page == nullptr || found.value % bricks_per_block >= page->bricks.mask.size() / brick_edge) return;
  place.kind = VoxelPlace::Kind::brick;
  place.block = &page->bricks;
  place.brick = found.value % bricks_per_block;
}

VoxelPlace VoxelLookup::place(int lod, const std::int64_t v[3], PageGaps& gaps) const {
  for (int holder = 0;; ++holder) {
    VoxelPlace place;
    const std::optional<PlacedShard> shard = map_.find(lod, holder, v, pager_, gaps, place.box);
    if (!shard) return place;
    const std::size_t missing = gaps.missing.size();
    place = place_in(*shard, lod, v, gaps);
    if (place.kind != VoxelPlace::Kind::unreadable || gaps.missing.size() != missing) return place;
    if (holder < map_.last_holder(lod)) continue;  // what it has a copy of
    gaps.damaged |= overlap(shard->window, gaps.own);
    gaps.beside_damaged |= shard->is_parent();
    return place;
  }
}

/// Unreadable where what says it will never be here.
VoxelPlace VoxelLookup::place_in(const PlacedShard& shard, int lod, const std::int64_t v[3], PageGaps& gaps) const {
  VoxelPlace place;
  const std::size_t missing = gaps.missing.size();
  std::int64_t corner[3];
  std::copy_n(shard.window.min, 3, corner);
  int level = shard.top();
  place.box = node_box(corner, level);
  const NodeRow* node = row(shard, 0, gaps);
  for (; node != nullptr && level > lod && node->kind != NodeKind::leaf_constant; --level) {
    int child = 0;
    for (int a = 0; a < 3; ++a) child |= int((v[a] - corner[a]) >> (level + 2) & 1) << a;
    for (int a = 0; a < 3; ++a) corner[a] += std::int64_t(child >> a & 1) << (level + 2);
    place.box = node_box(corner, level - 1);
    if ((node->child_mask >> child & 1) == 0) return place;
    node = row(shard, child_row(*node, child), gaps);
  }
  if (node != nullptr) set_content(shard, *node, lod, gaps, place);
  if (place.kind == VoxelPlace::Kind::nothing && gaps.missing.size() == missing)
    place.kind = VoxelPlace::Kind::unreadable;
  return place;
}

}  // namespace gigabake
