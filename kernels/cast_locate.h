/// Where in a scene a voxel lies: the brick or constant that holds it, or the empty box around it.
#pragma once

#include <cstdint>

#if !defined(__CUDA_ARCH__)
#include <atomic>
#endif

#include "kernels/cast_scene.h"
#include "kernels/types.h"

namespace gigabake::kernels {

GB_HD int count_bits(std::uint64_t v) {
#if defined(__CUDA_ARCH__)
  return __popcll(v);
#else
  return __builtin_popcountll(v);
#endif
}

/// Index of the highest set bit; v ≠ 0.
GB_HD int highest_bit(std::uint64_t v) {
#if defined(__CUDA_ARCH__)
  return 63 - __clzll(static_cast<long long>(v));
#else
  return 63 - __builtin_clzll(v);
#endif
}

/// Every ray writes the same number, so the order does not matter.
GB_HD void mark_used(const CastScene& scene, std::uint32_t page) {
#if defined(__CUDA_ARCH__)
  scene.page_used[page] = scene.pass;
#else
  const std::atomic_ref<std::uint32_t> used(scene.page_used[page]);
  if (used.load(std::memory_order_relaxed) != scene.pass) used.store(scene.pass, std::memory_order_relaxed);
#endif
}

GB_HD std::uint64_t spread_bits_2d(std::uint64_t v) {
  v = (v | v << 16) & 0x0000ffff0000ffffull;
  v = (v | v << 8) & 0x00ff00ff00ff00ffull;
  v = (v | v << 4) & 0x0f0f0f0f0f0f0f0full;
  v = (v | v << 2) & 0x3333333333333333ull;
  return (v | v << 1) & 0x5555555555555555ull;
}

GB_HD std::uint64_t column_key(std::uint32_t x, std::uint32_t y) { return spread_bits_2d(x) | spread_bits_2d(y) << 1; }

/// The answer holds for every voxel of the box [min, max). Neither brick nor constant: nothing is there.
struct CastPlace {
  std::int64_t min[3] = {0, 0, 0}, max[3] = {0, 0, 0};
  std::uint32_t cell = no_page;          ///< that holds it; no_page: none
  std::int64_t cell_min[3] = {0, 0, 0};  ///< its corner, which the levels are aligned with; 0 outside of all cells
  const CastBrick* brick = nullptr;
  const CastVoxel* voxels = nullptr;    ///< of the brick's level
  const CastVoxel* constant = nullptr;  ///< instead of a brick: the value of every voxel
  std::uint32_t missing = no_page;      ///< not no_page: unknown before this page is here

  GB_HD bool contains(const std::int64_t v[3]) const {
    return v[0] >= min[0] && v[0] < max[0] && v[1] >= min[1] && v[1] < max[1] && v[2] >= min[2] && v[2] < max[2];
  }
  GB_HD bool empty() const { return brick == nullptr && constant == nullptr; }
};

/// Index of the first column whose key is ≥ key.
GB_HD std::size_t lower_column(const CastScene& scene, std::uint64_t key) {
  std::size_t begin = 0, end = scene.column_key.size;
  while (begin < end) {
    const std::size_t middle = (begin + end) / 2;
    if (scene.column_key[middle] < key)
      begin = middle + 1;
    else
      end = middle;
  }
  return begin;
}

/// The largest aligned square of columns around an absent one that holds no column: no other column shares its prefix.
GB_HD void set_empty_square(const CastScene& scene, std::uint64_t key, std::size_t next, const std::int64_t column[2],
                            CastPlace& place) {
  int size_bits = 31;
  for (int side = 0; side < 2; ++side) {
    if (side == 0 ? next == 0 : next == scene.column_key.size) continue;
    const std::uint64_t other = scene.column_key[side == 0 ? next - 1 : next];
    const int bits = highest_bit(key ^ other) / 2;
    if (bits < size_bits) size_bits = bits;
  }
  for (int a = 0; a < 2; ++a) {
    const std::int64_t low = scene.column_min[a] + (column[a] >> size_bits << size_bits);
    place.min[a] = low * (std::int64_t(1) << scene.cell_bits);
    place.max[a] = (low + (std::int64_t(1) << size_bits)) * (std::int64_t(1) << scene.cell_bits);
  }
}

/// True and the cell's index where a cell holds the voxel; else `place` is the empty box around it.
GB_HD bool find_cell(const CastScene& scene, const std::int64_t v[3], CastPlace& place, std::uint32_t& cell) {
  for (int a = 0; a < 3; ++a) {
    place.min[a] = -far_voxel;
    place.max[a] = far_voxel;
  }
  std::int64_t column[2];
  for (int a = 0; a < 2; ++a) {
    column[a] = (v[a] >> scene.cell_bits) - scene.column_min[a];
    const std::int64_t edge = std::int64_t(1) << scene.cell_bits;
    if (column[a] < 0) {
      place.max[a] = scene.column_min[a] * edge;
      return false;
    }
    if (column[a] >= scene.column_count[a]) {
      place.min[a] = (scene.column_min[a] + scene.column_count[a]) * edge;
      return false;
    }
  }
  const std::uint64_t key = column_key(std::uint32_t(column[0]), std::uint32_t(column[1]));
  const std::size_t found = lower_column(scene, key);
  if (found == scene.column_key.size || scene.column_key[found] != key) {
    set_empty_square(scene, key, found, column, place);
    return false;
  }
  for (int a = 0; a < 2; ++a) {
    place.min[a] = v[a] >> scene.cell_bits << scene.cell_bits;
    place.max[a] = place.min[a] + (std::int64_t(1) << scene.cell_bits);
  }
  for (cell = scene.column_first[found]; cell < scene.column_first[found + 1]; ++cell) {
    const std::int64_t low = scene.cells[cell].min[2], high = low + (std::int64_t(1) << scene.cell_bits);
    if (v[2] < low) {
      place.max[2] = low;
      return false;
    }
    if (v[2] < high) return true;
    place.min[2] = high;
  }
  return false;
}

GB_HD void set_node_box(const CastCell& cell, const std::uint32_t local[3], int lod, CastPlace& place) {
  for (int a = 0; a < 3; ++a) {
    place.min[a] = cell.min[a] + std::int64_t(local[a] >> (3 + lod) << (3 + lod));
    place.max[a] = place.min[a] + (std::int64_t(brick_edge) << lod);
  }
}

/// Down from the root to the node of level `lod`, or to the coarser node where the tree ends.
GB_HD void descend(const CastScene& scene, std::uint32_t index, int lod, const std::int64_t v[3], CastPlace& place) {
  const CastCell& cell = scene.cells[index];
  if (cell.nodes == nullptr) {
    place.missing = node_page(index);
    return;
  }
  mark_used(scene, node_page(index));
  std::uint32_t local[3];
  for (int a = 0; a < 3; ++a) {
    local[a] = std::uint32_t(v[a] - cell.min[a]);
    place.cell_min[a] = cell.min[a];
  }
  const CastNode* node = cell.nodes;
  int l = scene.lods - 1;
  for (; l > lod && node->kind != CastNodeKind::leaf_constant; --l) {
    const int child =
        int(local[0] >> (2 + l) & 1) | int(local[1] >> (2 + l) & 1) << 1 | int(local[2] >> (2 + l) & 1) << 2;
    if ((node->child_mask >> child & 1) == 0) return set_node_box(cell, local, l - 1, place);
    node = cell.nodes + node->first_child + count_bits(node->child_mask & ((1u << child) - 1));
  }
  set_node_box(cell, local, l, place);
  if (node->kind != CastNodeKind::brick) {
    place.constant = cell.constants + node->value;
    return;
  }
  const CastLevel& level = cell.level[lod];
  if (level.bricks == nullptr) {
    place.missing = level_page(index, lod);
    return;
  }
  mark_used(scene, level_page(index, lod));
  place.brick = level.bricks + node->value;
  place.voxels = level.voxels;
}

/// v: any lod-0 voxel inside the wanted voxel of level `lod`. last: an earlier answer, whose cell is tried first.
GB_HD CastPlace locate(const CastScene& scene, int lod, const std::int64_t v[3], const CastPlace& last) {
  CastPlace place;
  place.cell = last.cell;
  const bool same_cell =
      last.cell != no_page &&
      (((v[0] - last.cell_min[0]) | (v[1] - last.cell_min[1]) | (v[2] - last.cell_min[2])) >> scene.cell_bits) == 0;
  if (same_cell || find_cell(scene, v, place, place.cell))
    descend(scene, place.cell, lod, v, place);
  else
    place.cell = no_page;
  return place;
}

}  // namespace gigabake::kernels
