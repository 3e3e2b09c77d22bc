/// Where in a scene a point lies: the brick that holds its field, or the box around it where the field is zero.
#pragma once

#include <cmath>
#include <cstdint>

#if !defined(__CUDA_ARCH__)
#include <atomic>
#endif

#include "kernels/cast/scene.h"
#include "lattice/brick.h"
#include "lattice/host_device.h"
#include "lattice/morton.h"

namespace gigabake::kernels {

/// Index of the highest set bit; v ≠ 0.
GB_HD int highest_bit(std::uint64_t v) {
#if defined(__CUDA_ARCH__)
  return 63 - __clzll(static_cast<long long>(v));
#else
  return 63 - __builtin_clzll(v);
#endif
}

GB_HD std::uint32_t mark_of(std::uint32_t* at) {
#if defined(__CUDA_ARCH__)
  return *at;
#else
  return std::atomic_ref<std::uint32_t>(*at).load(std::memory_order_relaxed);
#endif
}

GB_HD void set_mark(std::uint32_t* at, std::uint32_t pass) {
#if defined(__CUDA_ARCH__)
  *at = pass;
#else
  std::atomic_ref<std::uint32_t>(*at).store(pass, std::memory_order_relaxed);
#endif
}

/// Every ray of a pass writes the same number, so the order does not matter.
GB_HD void stamp(std::uint32_t* at, std::uint32_t pass) {
  if (mark_of(at) != pass) set_mark(at, pass);
}

/// Most rays find it set: they read it first, where others write it (on a device, not in a cache of their own).
GB_HD void set_bit(std::uint32_t* words, std::size_t bit) {
  std::uint32_t* const at = words + bit / 32;
  const std::uint32_t one = 1u << bit % 32;
#if defined(__CUDA_ARCH__)
  if ((__ldcg(at) & one) == 0) atomicOr(at, one);
#else
  const std::atomic_ref<std::uint32_t> word(*at);
  if ((word.load(std::memory_order_relaxed) & one) == 0) word.fetch_or(one, std::memory_order_relaxed);
#endif
}

GB_HD void want(const CastScene& scene, std::uint32_t node, Want what) {
  set_bit(scene.marks.wanted, 2 * std::size_t(node) + std::size_t(what));
}

/// Voxels [min, max).
struct VoxelBox {
  std::int64_t min[3], max[3];
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
                            VoxelBox& box) {
  int size_bits = 31;
  for (int side = 0; side < 2; ++side) {
    if (side == 0 ? next == 0 : next == scene.column_key.size) continue;
    const std::uint64_t other = scene.column_key[side == 0 ? next - 1 : next];
    const int bits = highest_bit(key ^ other) / 2;
    if (bits < size_bits) size_bits = bits;
  }
  for (int a = 0; a < 2; ++a) {
    const std::int64_t low = scene.column_min[a] + (column[a] >> size_bits << size_bits);
    box.min[a] = low * (std::int64_t(1) << scene.cell_bits);
    box.max[a] = (low + (std::int64_t(1) << size_bits)) * (std::int64_t(1) << scene.cell_bits);
  }
}

/// True and the cell's index where a cell holds the voxel; else `box` is the empty box around it.
GB_HD bool find_cell(const CastScene& scene, const std::int64_t v[3], std::uint32_t& cell, VoxelBox& box) {
  for (int a = 0; a < 3; ++a) {
    box.min[a] = -far_voxel;
    box.max[a] = far_voxel;
  }
  std::int64_t column[2];
  for (int a = 0; a < 2; ++a) {
    column[a] = (v[a] >> scene.cell_bits) - scene.column_min[a];
    const std::int64_t edge = std::int64_t(1) << scene.cell_bits;
    if (column[a] < 0) {
      box.max[a] = scene.column_min[a] * edge;
      return false;
    }
    if (column[a] >= scene.column_count[a]) {
      box.min[a] = (scene.column_min[a] + scene.column_count[a]) * edge;
      return false;
    }
  }
  const std::uint64_t key = morton(std::uint32_t(column[0]), std::uint32_t(column[1]));
  const std::size_t found = lower_column(scene, key);
  if (found == scene.column_key.size || scene.column_key[found] != key) {
    set_empty_square(scene, key, found, column, box);
    return false;
  }
  for (int a = 0; a < 2; ++a) {
    box.min[a] = v[a] >> scene.cell_bits << scene.cell_bits;
    box.max[a] = box.min[a] + (std::int64_t(1) << scene.cell_bits);
  }
  for (cell = scene.column_first[found]; cell < scene.column_first[found + 1]; ++cell) {
    const std::int64_t low = scene.cells[cell].min[2], high = low + (std::int64_t(1) << scene.cell_bits);
    if (v[2] < low) {
      box.max[2] = low;
      return false;
    }
    if (v[2] < high) return true;
    box.min[2] = high;
  }
  return false;
}

inline constexpr std::uint32_t no_cell = 0xffffffffu;

/// The answer holds for points p whose lowest voxel centre, p - half, lies in [min, max).
struct CastPlace {
  double min[3] = {0, 0, 0}, max[3] = {0, 0, 0};
  double half = 0;                  ///< half an edge of the brick's voxels
  double corner[3] = {0, 0, 0};     ///< of the brick
  std::uint32_t brick = empty_ref;  ///< slot; empty_ref: the field of this level is zero
  double beyond = 0;                ///< where it is, it is so for this much more on the upper sides
  std::int32_t lod = 0;             ///< of the brick: the one asked for, or coarser where that is not here
  std::uint32_t cell = no_cell;     ///< that holds it
  bool waits = false;               ///< something finer will be here

  GB_HD bool contains(const double p[3]) const {
    bool inside = true;
    for (int a = 0; a < 3; ++a) {
      const double v = p[a] - half;
      inside = inside & (v >= min[a]) & (v < max[a]);
    }
    return inside;
  }
};

/// An answer that holds for no point; the next one's cell is likely this one.
GB_HD CastPlace nowhere_in(std::uint32_t cell) {
  CastPlace place;
  place.cell = cell;
  return place;
}

/// Where a descent ended.
struct CastDescent {
  std::uint32_t index;  ///< of the node
  int lod;
  NodeWord word;
};

/// The latest way down: the next one starts where the two part.
struct CastPath {
  std::uint32_t cell = no_cell;
  std::uint32_t local[3] = {0, 0, 0};  ///< where it led, lod-0 voxels from the cell's corner
  std::int32_t lowest = 0;             ///< level it ended at
  std::uint32_t tile[max_cast_lods];   ///< by level, above `lowest`: the children of the node that it went through
};

/// The lowest level of the path that a way to this voxel shares.
GB_HD int shared_level(const CastPath& path, const std::uint32_t local[3]) {
  const std::uint32_t differ = (local[0] ^ path.local[0]) | (local[1] ^ path.local[1]) | (local[2] ^ path.local[2]);
  const int level = differ < brick_edge ? 0 : highest_bit(differ) - 2;
  return level > path.lowest ? level : path.lowest;
}

/// The level whose node a way to this voxel reads first: one below the last that it shares with the path, where the
/// path knows its children.
GB_HD int first_level(const CastScene& scene, const CastPath& path, std::uint32_t cell, const std::uint32_t local[3],
                      int lod) {
  if (cell != path.cell) return scene.lods - 1;
  const int shared = shared_level(path, local), first = shared > path.lowest ? shared - 1 : shared;
  return first > lod ? first : lod;
}

/// The child on the way to the voxel, of level `lod`, among the nodes of a tile.
GB_HD std::uint32_t child_of(std::uint32_t tile, const std::uint32_t local[3], int lod) {
  const int bit = 3 + lod;
  return 8 * tile + ((local[0] >> bit & 1) | (local[1] >> bit & 1) << 1 | (local[2] >> bit & 1) << 2);
}

/// From a cell's root towards the node of level `lod` that holds the voxel; ends early at what is empty or not here.
/// A tile's mark is read beside the node, since the next read waits for both.
GB_HD CastDescent descend(const CastScene& scene, std::uint32_t cell, int lod, const std::uint32_t local[3],
                          CastPath& path) {
  CastDescent at;
  at.lod = first_level(scene, path, cell, local, lod);
  at.index = at.lod == scene.lods - 1 ? cell : child_of(path.tile[at.lod + 1], local, at.lod);
  std::uint32_t mark = mark_of(scene.marks.tile_used + at.index / 8);
  at.word = scene.nodes[at.index];
  while (at.lod > lod && leads_on(at.word)) {
    path.tile[at.lod--] = at.word;
    at.index = child_of(at.word, local, at.lod);
    mark = mark_of(scene.marks.tile_used + at.index / 8);
    at.word = scene.nodes[at.index];
  }
  path.cell = cell;
  path.lowest = at.lod;
  for (int a = 0; a < 3; ++a) path.local[a] = local[a];
  if (mark != scene.pass) set_mark(scene.marks.tile_used + at.index / 8, scene.pass);
  return at;
}

/// The corner of the node of level `lod` that holds the voxel.
GB_HD void set_node_corner(const CastCell& cell, const std::uint32_t local[3], int lod, double corner[3]) {
  for (int a = 0; a < 3; ++a) corner[a] = double(cell.min[a] + std::int64_t(local[a] >> (3 + lod) << (3 + lod)));
}

/// The box of that node.
GB_HD void set_node_box(const CastCell& cell, const std::uint32_t local[3], int lod, CastPlace& place) {
  set_node_corner(cell, local, lod, place.min);
  const double edge = power_of_two(3 + lod);
  for (int a = 0; a < 3; ++a) place.max[a] = place.min[a] + edge;
}

/// The brick of the node where the descent ended. It stands for what is finer and not here: in a box of level `known`,
/// since beyond it more may be.
GB_HD void set_brick(const CastScene& scene, int lod, std::uint32_t brick, const std::uint32_t local[3], int known,
                     CastPlace& place) {
  const CastCell& cell = scene.cells[place.cell];
  set_node_box(cell, local, known, place);
  for (int a = 0; a < 3; ++a) place.corner[a] = place.min[a];
  if (known != lod) set_node_corner(cell, local, lod, place.corner);
  place.lod = lod;
  place.brick = brick;
  stamp(scene.marks.slot_used + place.brick, scene.pass);
}

/// Notes what of the node where the descent ended a ray of level `lod` misses. True where it is worth waiting for.
GB_HD bool ask_for(const CastScene& scene, const CastDescent& at, const CastNode& node, int lod) {
  const Want what = at.lod > lod ? Want::children : Want::brick;
  if ((what == Want::children ? node.children : node.brick) != absent_ref) return false;
  want(scene, at.index, what);
  return true;
}

/// The field of level `lod` around p; where what holds it is not here, a coarser one, unless `patient`: then the answer
/// says no more than that the ray waits. last: an earlier answer, whose cell is tried first. path: of the same pass.
/// Cost  A descent from where the path parts, a dependent read a level; one more for each level that is not here.
GB_HD CastPlace locate(const CastScene& scene, int lod, const double p[3], bool patient, const CastPlace& last,
                       CastPath& path) {
  CastPlace place;
  place.cell = last.cell;
  int known = -1;  // where the first descent ended: nothing finer is here in that node
  for (int level = lod;; ++level) {
    place.half = power_of_two(level - 1);
    std::int64_t v[3];
    std::uint32_t local[3];
    for (int a = 0; a < 3; ++a) v[a] = std::int64_t(std::floor(p[a] - place.half));
    VoxelBox box;
    const std::int64_t* corner = place.cell == no_cell ? v : scene.cells[place.cell].min;
    const bool same_cell =
        place.cell != no_cell && ((v[0] - corner[0]) | (v[1] - corner[1]) | (v[2] - corner[2])) >> scene.cell_bits == 0;
    if (!same_cell && !find_cell(scene, v, place.cell, box)) {
      place.cell = no_cell;
      for (int a = 0; a < 3; ++a) {
        place.min[a] = double(box.min[a]);
        place.max[a] = double(box.max[a]);
      }
      return place;
    }
    for (int a = 0; a < 3; ++a) local[a] = std::uint32_t(v[a] - scene.cells[place.cell].min[a]);
    const CastDescent at = descend(scene, place.cell, level, local, path);
    const CastNode node = scene.node_of(at.word);
    if (node.brick == empty_ref) {
      set_node_box(scene.cells[place.cell], local, at.lod, place);
      place.beyond = power_of_two(at.lod) - power_of_two(level);
      return place;
    }
    if (known < 0) known = at.lod;
    place.waits |= ask_for(scene, at, node, level);
    if (patient && place.waits) return place;
    if (at.lod == level && is_here(node.brick)) {
      set_brick(scene, level, node.brick, local, known, place);
      return place;
    }
    if (level == scene.lods - 1) {  // not even the root is here
      set_node_box(scene.cells[place.cell], local, level, place);
      return place;
    }
    level = at.lod == level ? level : at.lod - 1;
  }
}

}  // namespace gigabake::kernels
