#include "viewer/stream/voxel_lookup.h"

#include <algorithm>
#include <bit>

namespace gigabake {
namespace {

using kernels::VoxelBox;

VoxelBox node_box(const Vec3i64& corner, int level) {
  return {corner, corner + Vec3i64::all(std::int64_t(brick_edge) << level)};
}

bool contains(const VoxelBox& box, const Vec3i64& v) {
  for (int a = 0; a < 3; ++a)
    if (v[a] < box.min[a] || v[a] >= box.max[a]) return false;
  return true;
}

VoxelBox common_box(const VoxelBox& a, const VoxelBox& b) {
  return {max_by_axis(a.min, b.min), min_by_axis(a.max, b.max)};
}

/// Returns the lowest level on which the path to voxel `local` of the shard equals the stored path.
int shared_level(const NodePath& path, const ShardExtent& shard, const Vec3i64& local) {
  if (path.shard != shard.number) return shard.top();
  const auto differ = std::uint64_t((local[0] ^ path.v[0]) | (local[1] ^ path.v[1]) | (local[2] ^ path.v[2]));
  const int level = differ < std::uint64_t(brick_edge) ? 0 : kernels::highest_bit(differ) - 2;
  return std::max(level, path.lowest);
}

/// Returns the offset of a child from the corner of its node of level `level`, in lod-0 voxels.
Vec3i64 octant_offset(int child, int level) { return Vec3i64{child & 1, child >> 1 & 1, child >> 2} << (level + 2); }

std::uint32_t child_row(const NodeRow& parent, int child) {
  return parent.first_child + std::uint32_t(std::popcount(parent.child_mask & ((1u << child) - 1)));
}

}  // namespace

const NodeRow* VoxelLookup::row(const ShardExtent& shard, std::uint32_t index, MissingPages& missing_pages) const {
  const Page* page = find_page(pager_, {shard.number, PageKey::node_rows, index / nodes_per_block}, missing_pages);
  return page == nullptr || index % nodes_per_block >= page->rows.size() ? nullptr
                                                                         : &page->rows[index % nodes_per_block];
}

/// Returns whether the row can never be read: its page is damaged, or has fewer rows than other rows refer to.
bool VoxelLookup::lacks_row(const ShardExtent& shard, std::uint32_t index) const {
  const PageKey key{shard.number, PageKey::node_rows, index / nodes_per_block};
  if (pager_.is_damaged(key)) return true;
  const Page* page = pager_.find(key);
  return page != nullptr && index % nodes_per_block >= page->rows.size();
}

VoxelBox VoxelLookup::Question::around() const {
  VoxelBox all = boxes[std::size_t(std::countr_zero(open))];
  for (unsigned rest = open; rest != 0; rest &= rest - 1) {
    const VoxelBox& box = boxes[std::size_t(std::countr_zero(rest))];
    all = {min_by_axis(all.min, box.min), max_by_axis(all.max, box.max)};
  }
  return all;
}

unsigned VoxelLookup::Question::reached_by(const VoxelBox& box) const {
  unsigned reached = 0;
  for (unsigned rest = open; rest != 0; rest &= rest - 1)
    if (overlap(boxes[std::size_t(std::countr_zero(rest))], box)) reached |= rest & (0 - rest);
  return reached;
}

VoxelLookup::Question VoxelLookup::Question::within(const VoxelBox& box) const {
  Question part{lod, provider, boxes, reached_by(box), is_for_leaves};
  for (VoxelBox& own : part.boxes) own = common_box(own, box);
  return part;
}

std::uint8_t VoxelLookup::occupied(int lod, const Boxes& boxes, MissingPages& missing_pages) const {
  return std::uint8_t(occupied_by_any({lod, 0, boxes, 255}, missing_pages));
}

std::uint8_t VoxelLookup::leaves(int lod, const Boxes& boxes, MissingPages& missing_pages) const {
  return std::uint8_t(occupied_by_any({lod, 0, boxes, 255, true}, missing_pages));
}

unsigned VoxelLookup::occupied_by_any(Question question, MissingPages& missing_pages) const {
  const unsigned asked = question.open;
  if (asked == 0) return 0;
  map_.any(question.lod, question.provider, question.around(), pager_, missing_pages, [&](const ShardExtent& shard) {
    question.open &= ~occupied_below(shard, 0, shard.top(), shard.window.min, question,
                                     question.reached_by(shard.window), missing_pages);
    return question.open == 0;
  });
  return asked & ~question.open;
}

/// Returns the boxes that shards stored below an unreadable overview may overlap.
unsigned VoxelLookup::may_be_occupied(const ShardExtent& shard, const Question& question,
                                      MissingPages& missing_pages) const {
  missing_pages.is_overview_damaged = true;
  const int below = shard.own_lod - 1;
  unsigned found = 0;
  Question part = question.within(shard.window);
  const unsigned asked = part.open;
  if (asked == 0) return 0;
  map_.any(below, map_.last_provider(below), part.around(), pager_, missing_pages, [&](const ShardExtent& stored) {
    found |= part.reached_by(stored.window);
    return found == asked;
  });
  return found;
}

/// Returns the boxes that unreadable nodes of the shard may overlap. If another provider stores the level too, queries
/// that provider.
unsigned VoxelLookup::unread_occupied(const ShardExtent& shard, const Question& question, unsigned open,
                                      MissingPages& missing_pages) const {
  Question part = question;
  part.open = open;
  if (question.provider < map_.last_provider(question.lod)) {
    ++part.provider;
    return occupied_by_any(part.within(shard.window), missing_pages);
  }
  if (shard.is_overview()) return may_be_occupied(shard, part, missing_pages);
  missing_pages.damaged |= overlap(shard.window, missing_pages.own);
  return open;
}

/// Returns the boxes that nodes of the question's level, or coarser leaves, overlap in the subtree of row `row_index`.
/// The node of this row exists and overlaps the boxes of `open`.
unsigned VoxelLookup::occupied_below(const ShardExtent& shard, std::uint32_t row_index, int level,
                                     const Vec3i64& corner, const Question& question, unsigned open,
                                     MissingPages& missing_pages) const {
  if (level == question.lod || open == 0) return question.is_for_leaves ? 0 : open;
  const NodeRow* node = row(shard, row_index, missing_pages);
  if (node == nullptr)
    return lacks_row(shard, row_index) && !question.is_for_leaves
               ? unread_occupied(shard, question, open, missing_pages)
               : 0;
  if (node->kind == NodeKind::leaf_constant) return question.is_for_leaves ? 0 : open;
  const unsigned leaves = question.is_for_leaves ? node->leaf_mask : 0u;
  unsigned found = 0;
  for (int child = 0; child < 8 && found != open; ++child) {
    if (((node->child_mask | leaves) >> child & 1) == 0) continue;
    const Vec3i64 at = corner + octant_offset(child, level);
    const unsigned reached = question.reached_by(node_box(at, level - 1)) & open & ~found;
    if ((leaves >> child & 1) != 0)
      found |= reached;
    else if (reached != 0)
      found |= occupied_below(shard, child_row(*node, child), level - 1, at, question, reached, missing_pages);
  }
  return found;
}

void VoxelLookup::set_content(const ShardExtent& shard, const NodeRow& found, int lod, MissingPages& missing_pages,
                              VoxelPlace& place) const {
  if (found.kind != NodeKind::brick) {
    place.kind = VoxelPlace::Kind::constant;
    for (std::size_t c = 0; c < 4; ++c) place.rgba[c] = std::uint8_t(found.value >> (8 * c));
    std::copy_n(found.normal, 2, place.normal.begin());
    std::copy_n(found.directional_coverage, directional_coverage_bytes, place.directional_coverage.begin());
    if (lod == 0) place.directional_coverage = finest_directional_coverage(found.directional_coverage);
    place.voxel_class = found.voxel_class;
    place.has_directional_coverage = place.directional_coverage != DirectionalCoverage{};
    return;
  }
  const Page* page =
      find_page(pager_, {shard.number, lod - shard.first_lod, found.value / bricks_per_block}, missing_pages);
  if (page == nullptr || found.value % bricks_per_block >= page->bricks.mask.size() / brick_edge) return;
  place.kind = VoxelPlace::Kind::brick;
  place.page = page;
  place.brick = found.value % bricks_per_block;
}

VoxelPlace VoxelLookup::place(int lod, const Vec3i64& v, MissingPages& missing_pages, NodePath& path) const {
  for (int provider = 0;; ++provider) {
    VoxelPlace place;
    if (provider > 0 || path.extent_lod != lod || !contains(path.extent.window, v)) {
      const std::optional<ShardExtent> found = map_.find(lod, provider, v, pager_, missing_pages, place.box);
      if (!found) return place;
      path.extent = *found;
      path.extent_lod = provider == 0 ? lod : -1;
    }
    const ShardExtent shard = path.extent;
    const std::size_t missing = missing_pages.missing.size();
    place = place_in(shard, lod, v, missing_pages, path);
    if (place.kind != VoxelPlace::Kind::unreadable || missing_pages.missing.size() != missing) return place;
    if (provider < map_.last_provider(lod)) continue;  // a further provider may be readable
    missing_pages.damaged |= overlap(shard.window, missing_pages.own);
    missing_pages.is_overview_damaged |= shard.is_overview();
    return place;
  }
}

/// Returns the content of the shard at v; `Kind::unreadable` if the data can never become resident.
VoxelPlace VoxelLookup::place_in(const ShardExtent& shard, int lod, const Vec3i64& v, MissingPages& missing_pages,
                                 NodePath& path) const {
  VoxelPlace place;
  const std::size_t missing = missing_pages.missing.size();
  const Vec3i64 local = v - shard.window.min;
  int level = std::max(lod, shared_level(path, shard, local));
  const NodeRow* node = level == shard.top() ? row(shard, 0, missing_pages) : path.node[level];
  Vec3i64 corner = shard.window.min + (local >> (level + 3) << (level + 3));
  place.box = node_box(corner, level);
  path.shard = node == nullptr ? no_shard : shard.number;
  path.lowest = level;
  path.v = local;
  path.node[level] = node;
  while (node != nullptr && level > lod && node->kind != NodeKind::leaf_constant) {
    int child = 0;
    for (int a = 0; a < 3; ++a) child |= int(local[a] >> (level + 2) & 1) << a;
    corner += octant_offset(child, level);
    place.box = node_box(corner, --level);
    if ((node->leaf_mask >> child & 1) != 0) {
      place.kind = VoxelPlace::Kind::leaf;
      place.leaf_lod = level + 1;
    }
    if ((node->child_mask >> child & 1) == 0) return place;
    node = row(shard, child_row(*node, child), missing_pages);
    if (node == nullptr) break;
    path.node[level] = node;
    path.lowest = level;
  }
  if (node != nullptr) set_content(shard, *node, lod, missing_pages, place);
  if (place.kind == VoxelPlace::Kind::nothing && missing_pages.missing.size() == missing)
    place.kind = VoxelPlace::Kind::unreadable;
  return place;
}

}  // namespace gigabake
