/// Location of a point in a scene: the brick that holds the point's field, or the empty box around the point.
#pragma once

#include <cmath>
#include <cstdint>

#if !defined(__CUDA_ARCH__)
#include <atomic>
#endif

#include "core/base/host_device.h"
#include "core/octree/brick.h"
#include "core/octree/morton.h"
#include "kernels/marching/fixed_point.h"
#include "kernels/marching/node_exits.h"
#include "kernels/marching/scene.h"
#include "kernels/marching/voxel_space.h"

namespace gigabake::kernels {

/// Marks find_brick(). Hosts inline it, because a call copies the point and the result through memory.
#if defined(__CUDACC__)
#define GB_HD_INLINED GB_HD
#else
#define GB_HD_INLINED __attribute__((always_inline)) inline
#endif

/// Returns the index of the highest set bit; v ≠ 0.
GB_HD int highest_bit(std::uint64_t v) {
#if defined(__CUDA_ARCH__)
  return 63 - __clzll(static_cast<long long>(v));
#else
  return 63 - __builtin_clzll(v);
#endif
}

GB_HD std::uint32_t timestamp_of(std::uint32_t* at) {
#if defined(__CUDA_ARCH__)
  return *at;
#else
  return std::atomic_ref<std::uint32_t>(*at).load(std::memory_order_relaxed);
#endif
}

GB_HD void set_timestamp(std::uint32_t* at, std::uint32_t pass) {
#if defined(__CUDA_ARCH__)
  *at = pass;
#else
  std::atomic_ref<std::uint32_t>(*at).store(pass, std::memory_order_relaxed);
#endif
}

/// Writes the current pass to a usage mark. All rays of a pass write the same number, so their order does not matter.
GB_HD void touch(std::uint32_t* at, std::uint32_t pass) {
  if (timestamp_of(at) != pass) set_timestamp(at, pass);
}

/// Sets a bit atomically. The bit is read first, because most rays find it already set. On a device the read bypasses
/// the L1 cache, so that it sees the writes of other multiprocessors.
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

GB_HD void request(const CastScene& scene, std::uint32_t node, RequestKind what) {
  set_bit(scene.feedback.requested, 2 * std::size_t(node) + std::size_t(what));
}

/// Returns the index of the first column whose key is ≥ key.
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

/// Sets x and y of `box` to the largest aligned square around a missing column that contains no column of the scene. No
/// key of the scene has the prefix of this square's keys. `next` is lower_column() of `key`.
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

/// Returns true and sets `cell` if a cell holds the voxel; otherwise sets `box` to an empty box around the voxel.
GB_HD bool find_cell(const CastScene& scene, const Vec3i64& v, std::uint32_t& cell, VoxelBox& box) {
  box = {Vec3i64::all(-far_voxel), Vec3i64::all(far_voxel)};
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

/// The bits of a cell that allow a fast test whether the cell holds a point.
struct CellFrame {
  std::uint32_t cell = no_cell;
  std::uint32_t column[2] = {0, 0};  ///< high bits that all points of the cell share in x and in y
  std::uint64_t low = 0;             ///< z of the cell's lower end relative to the scene's corner, 1/65536 voxel

  GB_HD bool holds(const CastScene& scene, const FixedPoint& point) const {
    const int shift = fraction_bits + scene.cell_bits;
    const std::uint32_t beside =
        (std::uint32_t(point.bits[0] >> shift) ^ column[0]) | (std::uint32_t(point.bits[1] >> shift) ^ column[1]);
    return cell != no_cell && beside == 0 && ((point.bits[2] - low) ^ fixed_bias_bits) >> shift == 0;
  }
};

/// The result of find_brick(): the brick that holds the field around a point.
struct SampleLocation {
  /// The point in fixed-point coordinates. Their origin is the lowest voxel centre of level `lod`: in the scene for x
  /// and y, in the cell for z.
  FixedPoint at;
  std::uint32_t brick = empty_ref;  ///< slot; empty_ref: the field of this level is zero
  /// The distance along the ray within which the result is the same, lod-0 voxels. Set if there is no brick.
  float exit_distance = 0;
  /// The step of the first sample for which the result may differ; the same for all samples before it. Set for a brick
  /// of a coarser level.
  double exit_step = no_exit;
  std::int32_t lod = 0;  ///< level of the brick: the requested level, or a coarser level if that is not resident
  bool waits = false;    ///< finer data was requested and will become resident
};

/// The node at which a descent ended.
struct CastDescent {
  std::uint32_t index;  ///< of the node
  int lod;
  NodeWord word;
};

/// The path of the latest descent. The next descent starts at the deepest node that it shares with this path.
struct CastPath {
  std::uint32_t cell = no_cell;
  Vec3<std::uint32_t> local{0, 0, 0};  ///< the descent's target, lod-0 voxels from the cell's corner
  std::int32_t lowest = 0;             ///< level at which the descent ended
  std::uint32_t tile[max_cast_lods];   ///< by level, for levels above `lowest`: the children of the path's node
};

/// Returns the lowest level on which `path` and the path to voxel `local` share a node.
GB_HD int shared_level(const CastPath& path, const Vec3<std::uint32_t>& local) {
  const std::uint32_t differ = (local[0] ^ path.local[0]) | (local[1] ^ path.local[1]) | (local[2] ^ path.local[2]);
  const int level = differ < brick_edge ? 0 : highest_bit(differ) - 2;
  return level > path.lowest ? level : path.lowest;
}

/// Returns the level of the first node that a descent to voxel `local` reads. This level is shared_level(), or the
/// level below it if `path` stores the children of the shared node.
GB_HD int first_level(const CastScene& scene, const CastPath& path, std::uint32_t cell,
                      const Vec3<std::uint32_t>& local, int lod) {
  if (cell != path.cell) return scene.lods - 1;
  const int shared = shared_level(path, local), first = shared > path.lowest ? shared - 1 : shared;
  return first > lod ? first : lod;
}

/// Returns the node of level `lod` in a tile that contains the voxel.
GB_HD std::uint32_t child_of(std::uint32_t tile, const Vec3<std::uint32_t>& local, int lod) {
  const int bit = 3 + lod;
  return 8 * tile + ((local[0] >> bit & 1) | (local[1] >> bit & 1) << 1 | (local[2] >> bit & 1) << 2);
}

/// Descends towards the node of level `lod` that holds the voxel, from the cell's root or from the deepest node that
/// `path` shares. Stops early at empty or missing nodes. Reads a tile's usage mark together with the node, so that both
/// loads overlap.
GB_HD CastDescent descend(const CastScene& scene, std::uint32_t cell, int lod, const Vec3<std::uint32_t>& local,
                          CastPath& path) {
  CastDescent at;
  at.lod = first_level(scene, path, cell, local, lod);
  at.index = at.lod == scene.lods - 1 ? cell : child_of(path.tile[at.lod + 1], local, at.lod);
  std::uint32_t timestamp = timestamp_of(scene.feedback.tile_used + at.index / 8);
  at.word = scene.nodes[at.index];
  while (at.lod > lod && leads_on(at.word)) {
    path.tile[at.lod--] = at.word;
    at.index = child_of(at.word, local, at.lod);
    timestamp = timestamp_of(scene.feedback.tile_used + at.index / 8);
    at.word = scene.nodes[at.index];
  }
  path.cell = cell;
  path.lowest = at.lod;
  path.local = local;
  if (timestamp != scene.pass) set_timestamp(scene.feedback.tile_used + at.index / 8, scene.pass);
  return at;
}

/// Requests the data that the descent's last node lacks for a ray of level `lod`. Returns true if the data will become
/// resident.
GB_HD bool request_missing(const CastScene& scene, const CastDescent& at, const CastNode& node, int lod) {
  const RequestKind what = at.lod > lod ? RequestKind::children : RequestKind::brick;
  if ((what == RequestKind::children ? node.children : node.brick) != not_resident_ref) return false;
  request(scene, at.index, what);
  return true;
}

/// A cell, or the empty space around a point.
struct FoundCell {
  std::uint32_t cell;   ///< no_cell: no cell holds the point
  float exit_distance;  ///< if there is no cell: exit distance from the empty space, lod-0 voxels
};

/// Finds the cell that holds voxel (x, y, z). The function is not inlined, because few steps enter another cell.
GB_HD_NOINLINE FoundCell look_for_cell(const CastScene& scene, std::int64_t x, std::int64_t y, std::int64_t z,
                                       CastLine line) {
  const Vec3i64 v{x, y, z};
  VoxelBox box;
  FoundCell found{no_cell, 1e30f};
  if (find_cell(scene, v, found.cell, box)) return found;
  constexpr float spare = 0.001f;
  for (int a = 0; a < 3; ++a) {
    const std::int64_t left = backward(line, a) != 0 ? v[a] - box.min[a] : box.max[a] - v[a] - 1;
    const float exit_distance = (float(left) - spare) * line.inv_direction[a];
    if (exit_distance < found.exit_distance) found.exit_distance = exit_distance;
  }
  found.cell = no_cell;
  return found;
}

/// Returns CellFrame::low of a cell.
GB_HD std::uint64_t low_of(const CastScene& scene, std::uint32_t cell) {
  return std::uint64_t(scene.cells[cell].min[2] - scene.corner[2]) << fraction_bits;
}

/// Sets `frame` to the cell that holds the point, and returns true. If no cell holds the point, returns false and sets
/// `exit_distance` to the exit distance from the empty space.
GB_HD bool enter_cell(const CastScene& scene, const CastLine& line, const FixedPoint& point, CellFrame& frame,
                      float& exit_distance) {
  if (frame.holds(scene, point)) return true;
  Vec3i64 v;
  for (int a = 0; a < 3; ++a) v[a] = (std::int64_t(point.bits[a] - fixed_bias_bits) >> fraction_bits) + scene.corner[a];
  const FoundCell found = look_for_cell(scene, v[0], v[1], v[2], line);
  frame.cell = found.cell;
  exit_distance = found.exit_distance;
  if (frame.cell == no_cell) return false;
  for (int a = 0; a < 2; ++a) frame.column[a] = std::uint32_t(point.bits[a] >> (fraction_bits + scene.cell_bits));
  frame.low = low_of(scene, frame.cell);
  return true;
}

/// Returns the exit distance, in lod-0 voxels, from the empty node at which a descent for level `of` ended. The
/// distance extends over empty siblings that the ray enters next. It also extends beyond the node's upper sides,
/// because the field is zero up to the next voxel centre of level `of`. In a scene with leaves it does not: the coarser
/// field of a leaf may begin there, and its first sample must not depend on where the ray came from.
GB_HD float exit_distance_empty(const CastScene& scene, const CastLine& line, const FixedPoint& point,
                                const CastDescent& at, int of) {
  constexpr float edge = float(node_mask + 1);
  Vec3<float> exit_distance;
  std::uint32_t ahead = 0;  // bit a: the node has a sibling ahead along axis a
  GB_UNROLL
  for (int a = 0; a < 3; ++a) {
    exit_distance[a] = distance_to_side(line, a, point.in_node(a, at.lod), node_mask + 1);
    ahead |= ~(at.index ^ backward(line, a)) & 1u << a;
  }
  if (at.lod + 1 == scene.lods) ahead = 0;
  std::uint32_t node = at.index;
  GB_NO_UNROLL
  while (true) {
    const int axis = exit_distance[0] < exit_distance[1] ? (exit_distance[0] < exit_distance[2] ? 0 : 2)
                                                         : (exit_distance[1] < exit_distance[2] ? 1 : 2);
    const std::uint32_t bit = 1u << axis;
    if ((ahead & bit) == 0 || scene.nodes[node ^ bit] != empty_node) break;
    // Stop if rounding could change which side the ray crosses first.
    const float unit = axis == 0 ? line.inv_direction[0] : axis == 1 ? line.inv_direction[1] : line.inv_direction[2];
    const float latest = min_of(exit_distance) + 2 * fixed_spare * unit;
    if ((axis != 0 && exit_distance[0] <= latest) || (axis != 1 && exit_distance[1] <= latest) ||
        (axis != 2 && exit_distance[2] <= latest))
      break;
    node ^= bit;
    ahead ^= bit;
    GB_UNROLL
    for (int a = 0; a < 3; ++a) exit_distance[a] += a == axis ? edge * unit : 0;
  }
  const float beyond = scene.has_leaves ? 0 : float(fixed_one - (fixed_one >> (at.lod - of)));
  GB_UNROLL
  for (int a = 0; a < 3; ++a) exit_distance[a] += backward(line, a) != 0 ? 0 : beyond * line.inv_direction[a];
  return min_of(exit_distance) * short_power_of_two(at.lod - fraction_bits);
}

/// Converts fixed-point coordinates from level `from` to level `to`. Each level's origin is its lowest voxel centre.
GB_HD void count_for_level(int from, int to, FixedPoint& point) {
  const std::uint64_t higher = (std::uint64_t(fixed_one) << to >> 1) - (std::uint64_t(fixed_one) << from >> 1);
  for (std::uint64_t& bits : point.bits) bits -= higher;
}

/// Finds the brick that holds the field of level `lod` around a point. If that brick is not resident, returns the
/// finest resident brick of a coarser level. If `blocking` is true and the data can be loaded, returns only `waits` =
/// true instead. `frame` is the cell that is tried first, and receives the cell that was found. `path` must stem from
/// the current pass.
/// Cost    One dependent load per level below the deepest node shared with `path`; one more descent per missing level.
GB_HD_INLINED SampleLocation find_brick(const CastScene& scene, const CastLine& line, const LevelPoints& points,
                                        int lod, const FixedPoint& point, bool blocking, CellFrame& frame,
                                        CastPath& path) {
  SampleLocation place;
  FixedPoint at = point;
  float within = 1e30f;  // exit distance from the nodes at which descents for finer levels ended
  for (place.lod = lod;;) {
    if (!enter_cell(scene, line, at, frame, place.exit_distance)) {
      place.exit_distance = smaller_of(place.exit_distance, within);
      return place;
    }
    place.at = at;
    place.at.bits[2] -= frame.low;
    const std::uint32_t in_cell = (1u << scene.cell_bits) - 1;
    const Vec3<std::uint32_t> local{place.at.voxel(0) & in_cell, place.at.voxel(1) & in_cell, place.at.voxel(2)};
    const CastDescent end = descend(scene, frame.cell, place.lod, local, path);
    const CastNode node = scene.node_of(end.word);
    if (node.brick == empty_ref) {
      place.exit_distance = smaller_of(exit_distance_empty(scene, line, place.at, end, place.lod), within);
      return place;
    }
    place.waits |= request_missing(scene, end, node, place.lod);
    if (blocking && place.waits) return place;
    if (end.lod == place.lod && is_resident(node.brick)) {
      place.brick = node.brick;
      if (place.lod != lod)
        place.exit_step = smaller_of(exit_step_node(line, points, lod, point, place.at, place.lod), place.exit_step);
      touch(scene.feedback.slot_used + place.brick, scene.pass);
      return place;
    }
    within = smaller_of(exit_distance_node(line, place.at, end.lod), within);
    place.exit_step = smaller_of(exit_step_node(line, points, lod, point, place.at, end.lod), place.exit_step);
    if (place.lod == scene.lods - 1) {  // the root is not resident either
      place.exit_distance = within;
      return place;
    }
    const int coarser = end.lod == place.lod ? place.lod + 1 : end.lod;
    count_for_level(place.lod, coarser, at);
    place.lod = coarser;
  }
}

}  // namespace gigabake::kernels
