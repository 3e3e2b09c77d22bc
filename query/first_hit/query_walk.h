/// Traversal of a scene's shards by a ray, from its start to its first hit, for host and device. The traversal pauses
/// if it needs data that is not resident. It can be resumed later, on the host or on the device.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "kernels/marching/fixed_point.h"
#include "query/first_hit/shard_tree.h"

namespace gigabake {

/// The levels that rays sample.
struct QueryLevels {
  int finest = 0;
  /// Growth of a ray's footprint per unit of distance. A ray samples the coarsest level whose voxels are not larger
  /// than its footprint, but no level finer than `finest`. 0: samples only `finest`.
  double spread = 0;
  int count = 1;  ///< levels of the scene
};

/// The contents of a scene at a voxel of a level, and the box in which these contents apply.
struct QueryRegion {
  enum class Kind : std::int32_t {
    nothing,
    shard,    ///< a resident shard; `tree` has its voxels
    missing,  ///< a lost or unreadable cell
    paused    ///< a shard that is not resident
  };
  Kind kind = Kind::nothing;
  std::uint32_t shard = 0;
  const kernels::ShardTree* tree = nullptr;
  kernels::VoxelBox box{};
};

/// The state of a ray's traversal.
struct QueryTraversal {
  std::int64_t v[3] = {};  ///< lod-0 voxel at distance `at`
  double at = 0;
  double leave = 0;  ///< distance at which the ray leaves the scene
  std::int32_t lod = 0;
  bool finished = false;
  QueryHit nearest;  ///< nearest hit so far; the result if `finished`
};

namespace kernels {

/// Returns the distance at which a ray begins to sample a level. The rays of images switch levels at the same distances
/// (kernels/marching/cast.h).
GB_HD double query_level_start(const QueryLevels& levels, int lod) {
  if (lod <= levels.finest) return 0;
  CastLine line{};
  line.lod1_distance = 2 / levels.spread;
  return lod_start(line, lod);
}

GB_HD double query_level_end(const QueryLevels& levels, int lod) {
  return levels.spread > 0 && lod + 1 < levels.count ? query_level_start(levels, lod + 1)
                                                     : std::numeric_limits<double>::infinity();
}

GB_HD void set_query_voxel(const QueryRay& ray, double at, std::int64_t v[3]) {
  for (int a = 0; a < 3; ++a) v[a] = std::int64_t(std::floor(ray.origin[a] + ray.direction[a] * at));
}

/// The distance and axis at which a ray leaves a box.
struct BoxExit {
  double at = std::numeric_limits<double>::infinity();
  int axis = 0;
};

GB_HD BoxExit exit_of(const QueryRay& ray, const VoxelBox& box) {
  BoxExit exit;
  for (int a = 0; a < 3; ++a) {
    if (ray.direction[a] == 0) continue;
    const double side = double(ray.direction[a] > 0 ? box.max[a] : box.min[a]);
    const double at = (side - ray.origin[a]) / ray.direction[a];
    if (at < exit.at) exit = {at, a};
  }
  return exit;
}

/// Moves the ray across the exit's face into the next box. The ray never crosses an edge directly: it reaches a box
/// that shares only an edge with this box through a box that shares a face.
GB_HD void cross_face(const QueryRay& ray, const VoxelBox& box, const BoxExit& exit, QueryTraversal& walk) {
  walk.at = larger_of(walk.at, exit.at);
  set_query_voxel(ray, walk.at, walk.v);
  for (int a = 0; a < 3; ++a) {
    const std::int64_t low = box.min[a], high = box.max[a] - 1;
    if (walk.v[a] < low) walk.v[a] = low;
    if (walk.v[a] > high) walk.v[a] = high;
    if (a == exit.axis) walk.v[a] = ray.direction[a] > 0 ? high + 1 : low - 1;
  }
}

/// Starts a traversal. `window` is the bounding box of all cells.
/// Range   All numbers of the ray except `end` are finite. The ray's direction is of unit length. levels.finest <
///         levels.count.
GB_HD QueryTraversal start_march(const QueryRay& ray, const QueryLevels& levels, const VoxelBox& window) {
  QueryTraversal walk;
  if (chord_of(ray, window, 0).empty()) {
    walk.nearest.outcome = QueryOutcome::outside;
    walk.finished = true;
    return walk;
  }
  // Coarse voxels at the scene's border extend beyond its box.
  const int coarsest = levels.spread > 0 ? levels.count - 1 : levels.finest;
  const RayChord chord = chord_of(ray, window, power_of_two(coarsest));
  walk.at = chord.enter;
  walk.leave = chord.leave;
  walk.lod = levels.finest;
  while (walk.at >= query_level_end(levels, walk.lod)) ++walk.lod;
  set_query_voxel(ray, walk.at, walk.v);
  return walk;
}

/// Continues the ray until it is finished, and returns true. Returns false if the ray must pause, because
/// scene.find(lod, v) returned a QueryRegion that is `paused`. `stack` is described at advance().
template <class Scene, class Stack>
GB_HD bool advance_walk(const QueryRay& ray, const QueryLevels& levels, const Scene& scene, Stack stack,
                        QueryTraversal& walk) {
  // A hit may lie outside its shard's window, by up to the edge of a voxel. Another shard may therefore have a closer
  // hit until the ray reaches the hit's distance.
  while (!walk.finished && walk.at <= walk.leave && walk.at < walk.nearest.distance) {
    const QueryRegion region = scene.find(walk.lod, walk.v);
    if (region.kind == QueryRegion::Kind::paused) return false;
    if (region.kind == QueryRegion::Kind::missing) {
      walk.nearest = {};
      walk.nearest.outcome = QueryOutcome::missing;
      walk.nearest.distance = walk.at;
      walk.nearest.lod = walk.lod;
      walk.nearest.shard = region.shard;
      break;
    }
    const double end = query_level_end(levels, walk.lod);
    if (region.kind == QueryRegion::Kind::shard) {
      const double begin = query_level_start(levels, walk.lod);
      const QueryHit hit = first_hit_in_shard(*region.tree, ray, larger_of(begin, ray.begin), smaller_of(end, ray.end),
                                              region.shard, stack);
      if (hit.distance < walk.nearest.distance) walk.nearest = hit;
    }
    const BoxExit exit = exit_of(ray, region.box);
    if (exit.at < end) {
      cross_face(ray, region.box, exit, walk);
    } else {
      ++walk.lod;
      walk.at = end;
      set_query_voxel(ray, walk.at, walk.v);
    }
  }
  walk.finished = true;
  return true;
}

}  // namespace kernels
}  // namespace gigabake
