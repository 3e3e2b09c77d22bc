/// First hits in one level of one shard, as `gigabake query` defines them, for host and device.
///
/// Voxels are slightly enlarged about the middle of the shard's window, so that no ray slips between two shards. At the
/// window's faces, the enlargement is 2^-19 of the tree's edge. This is 1/128 voxel in a window of 1024 voxels, and
/// 1/32 voxel in the largest window.
#pragma once

#include <cstdint>

#include "kernels/marching/cast_line.h"
#include "query/first_hit/first_hit.h"
#include "query/first_hit/query_ray.h"

namespace gigabake::kernels {

/// A tree that rays borrow. Its coordinates have the unit `unit` and begin at the window's corner.
struct ShardTree {
  FirstHitTree tree;
  Span<const VoxelAttributes> attributes;
  Span<const std::uint16_t> classes;  ///< one per entry of `attributes`; empty without classes
  VoxelBox window{};                  ///< lod-0 voxels of the lattice
  std::int64_t tree_min[3] = {};      ///< the tree's lowest corner
  double unit = 1;                    ///< edge of a voxel of the shard's own level 0, lod-0 voxels
  double half_window = 0;
  double grown = 1;            ///< enlargement factor of the voxels
  std::int32_t lod = 0;        ///< level of the tree's voxels
  std::int32_t shard_lod = 0;  ///< the same level, counted from the shard's own level 0
};

/// Returns the part `chord` of the ray in the tree's coordinates. The returned ray starts where the ray enters the
/// window, so that single precision suffices inside.
GB_HD FirstHitRay ray_in_shard(const ShardTree& shard, const QueryRay& ray, const RayChord& chord) {
  FirstHitRay local;
  for (int a = 0; a < 3; ++a) {
    const double p = ray.origin[a] + ray.direction[a] * chord.enter - double(shard.window.min[a]);
    local.origin[a] = shard.half_window + (p / shard.unit - shard.half_window) / shard.grown;
    local.direction[a] = float(ray.direction[a]);
  }
  local.end = float((chord.leave - chord.enter) / (shard.unit * shard.grown));
  return local;
}

/// Returns the first voxel, of the tree's level or a leaf, that the ray hits between the distances `from` and `to`.
/// `shard_number` is stored in the hit. `stack` is described at advance().
/// Exact   Host and device return the same bits. The voxel is found with an error of the position on the ray of at most
///         half the enlargement. The distance is the ray's entry into that voxel, computed in double precision.
template <class Stack>
GB_HD QueryHit first_hit_in_shard(const ShardTree& shard, const QueryRay& ray, double from, double to,
                                  std::uint32_t shard_number, Stack stack) {
  QueryHit hit;
  RayChord chord = chord_of(ray, shard.window, power_of_two(shard.lod));
  chord = {larger_of(chord.enter, from), smaller_of(chord.leave, to)};
  if (chord.empty()) return hit;
  const FirstHitTree tree = shard.tree;
  const FirstHit found = first_hit(tree, ray_in_shard(shard, ray, chord), 0, stack);
  if (found.attributes_index == no_attributes) return hit;
  const VoxelAttributes of_voxel = shard.attributes[found.attributes_index];
  hit.outcome = QueryOutcome::hit;
  hit.lod = shard.lod + of_voxel.coarser;
  hit.shard = shard_number;
  const int leaf_lod = shard.shard_lod + of_voxel.coarser;
  const auto voxel = std::int64_t(power_of_two(hit.lod));
  VoxelBox box;
  for (int a = 0; a < 3; ++a) {
    const std::int64_t at = std::int64_t(found.voxel >> 21 * a & 0x1fffff) << shard.shard_lod,
                       of_leaf = (shard.tree_min[a] + at) >> leaf_lod << leaf_lod;
    hit.voxel[a] = shard.window.min[a] + of_leaf * std::int64_t(shard.unit);
    box.min[a] = hit.voxel[a];
    box.max[a] = hit.voxel[a] + voxel;
  }
  const RayChord exact = chord_of(ray, box, 0);
  const double rough = chord.enter + double(found.distance) * shard.unit * shard.grown;
  hit.distance = smaller_of(larger_of(exact.empty() ? rough : exact.enter, from), to);
  hit.rgba = of_voxel.rgba;
  hit.normal[0] = of_voxel.normal[0];
  hit.normal[1] = of_voxel.normal[1];
  hit.plane = of_voxel.plane;
  if (shard.classes.size != 0) hit.voxel_class = shard.classes[found.attributes_index];
  return hit;
}

}  // namespace gigabake::kernels
