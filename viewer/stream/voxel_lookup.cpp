#include "viewer/stream/voxel_lookup.h"

#include <algorithm>
#include <bit>

#include "lattice/morton.h"

namespace gigabake {
namespace {

using kernels::VoxelBox;

bool overlap(const VoxelBox& a, const VoxelBox& b) {
  for (int i = 0; i < 3; ++i)
    if (a.max[i] <= b.min[i] || b.max[i] <= a.min[i]) return false;
  return true;
}

VoxelBox node_box(const std::int64_t corner[3], int level) {
  VoxelBox box;
  for (int a = 0; a < 3; ++a) {
    box.min[a] = corner[a];
    box.max[a] = corner[a] + (std::int64_t(brick_edge) << level);
  }
  return box;
}

std::uint32_t child_row(const NodeRow& parent, int child) {
  return parent.first_child + std::uint32_t(std::popcount(parent.child_mask & ((1u << child) - 1)));
}

const Page* find_page(const Pager& pager, const PageKey& key, PageGaps& gaps) {
  const Page* page = pager.find(key);
  if (page != nullptr) return page;
  if (pager.is_damaged(key))
    gaps.damaged |= key.cell == gaps.scene_cell;
  else
    gaps.missing.push_back(key);
  return nullptr;
}

/// Calls visit(cell) for the cells of the layout that overlap the box until one says true.
template <class Visit>
bool any_cell(const CellLayout& layout, const VoxelBox& box, const Visit& visit) {
  const kernels::CastScene& scene = layout.scene;
  for (std::int64_t y = box.min[1] >> scene.cell_bits; y <= (box.max[1] - 1) >> scene.cell_bits; ++y)
    for (std::int64_t x = box.min[0] >> scene.cell_bits; x <= (box.max[0] - 1) >> scene.cell_bits; ++x) {
      const std::int64_t column[2] = {x - scene.column_min[0], y - scene.column_min[1]};
      if (column[0] < 0 || column[1] < 0 || column[0] >= scene.column_count[0] || column[1] >= scene.column_count[1])
        continue;
      const std::uint64_t key = morton(std::uint32_t(column[0]), std::uint32_t(column[1]));
      const std::size_t at = kernels::lower_column(scene, key);
      if (at == layout.column_key.size() || layout.column_key[at] != key) continue;
      for (std::uint32_t cell = layout.column_first[at]; cell < layout.column_first[at + 1]; ++cell) {
        const std::int64_t low = layout.cells[cell].min[2], high = low + (std::int64_t(1) << scene.cell_bits);
        if (layout.scene_cell[cell] != rim_cell && low < box.max[2] && high > box.min[2] && visit(cell)) return true;
      }
    }
  return false;
}

}  // namespace

const NodeRow* VoxelLookup::row(std::uint32_t scene_cell, std::uint32_t index, PageGaps& gaps) const {
  const Page* page = find_page(pager_, {scene_cell, -1, index / nodes_per_block}, gaps);
  return page == nullptr ? nullptr : &page->rows[index % nodes_per_block];
}

bool VoxelLookup::is_occupied(int lod, const VoxelBox& box, PageGaps& gaps) const {
  return any_cell(layout_, box, [&](std::uint32_t cell) {
    return is_occupied_below(cell, 0, layout_.scene.lods - 1, layout_.cells[cell].min, lod, box, gaps);
  });
}

/// The node of row_index is there and overlaps the box.
bool VoxelLookup::is_occupied_below(std::uint32_t cell, std::uint32_t row_index, int level,
                                    const std::int64_t corner[3], int lod, const VoxelBox& box, PageGaps& gaps) const {
  if (level == lod) return true;
  const NodeRow* node = row(layout_.scene_cell[cell], row_index, gaps);
  if (node == nullptr) return false;
  if (node->kind == NodeKind::leaf_constant) return true;
  for (int child = 0; child < 8; ++child) {
    if ((node->child_mask >> child & 1) == 0) continue;
    std::int64_t at[3];
    for (int a = 0; a < 3; ++a) at[a] = corner[a] + (std::int64_t(child >> a & 1) << (level + 2));
    if (overlap(node_box(at, level - 1), box) &&
        is_occupied_below(cell, child_row(*node, child), level - 1, at, lod, box, gaps))
      return true;
  }
  return false;
}

void VoxelLookup::set_content(std::uint32_t scene_cell, const NodeRow& found, int lod, PageGaps& gaps,
                              VoxelPlace& place) const {
  if (found.kind != NodeKind::brick) {
    place.kind = VoxelPlace::Kind::constant;
    for (std::size_t c = 0; c < 4; ++c) place.rgba[c] = std::uint8_t(found.value >> (8 * c));
    std::copy_n(found.normal, 2, place.normal.begin());
    std::copy_n(found.facing, facing_bytes, place.facing.begin());
    place.has_facing = lod > 0 && place.facing != Facing{};
    return;
  }
  const Page* page = find_page(pager_, {scene_cell, lod, found.value / bricks_per_block}, gaps);
  if (page == nullptr) return;
  place.kind = VoxelPlace::Kind::brick;
  place.block = &page->bricks;
  place.brick = found.value % bricks_per_block;
}

VoxelPlace VoxelLookup::place(int lod, const std::int64_t v[3], PageGaps& gaps) const {
  VoxelPlace place;
  std::uint32_t cell = 0;
  if (!kernels::find_cell(layout_.scene, v, cell, place.box)) return place;
  const std::uint32_t scene_cell = layout_.scene_cell[cell];
  std::int64_t corner[3];
  std::copy_n(layout_.cells[cell].min, 3, corner);
  int level = layout_.scene.lods - 1;
  place.box = node_box(corner, level);
  if (scene_cell == rim_cell) return place;
  const NodeRow* node = row(scene_cell, 0, gaps);
  for (; node != nullptr && level > lod && node->kind != NodeKind::leaf_constant; --level) {
    int child = 0;
    for (int a = 0; a < 3; ++a) child |= int((v[a] - corner[a]) >> (level + 2) & 1) << a;
    for (int a = 0; a < 3; ++a) corner[a] += std::int64_t(child >> a & 1) << (level + 2);
    place.box = node_box(corner, level - 1);
    if ((node->child_mask >> child & 1) == 0) return place;
    node = row(scene_cell, child_row(*node, child), gaps);
  }
  if (node != nullptr) set_content(scene_cell, *node, lod, gaps, place);
  return place;
}

}  // namespace gigabake
