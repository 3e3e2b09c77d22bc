#include "viewer/query/query_walk.h"

#include <algorithm>
#include <cmath>

#include "kernels/marching/cast.h"

namespace gigabake {
namespace {

/// Returns the distance at which a ray begins to sample a level; images use the same steps (kernels/marching/cast.h).
double level_start(const QueryLevels& levels, int lod) {
  if (lod <= levels.finest) return 0;
  kernels::CastLine line{};
  line.lod1_distance = 2 / levels.spread;
  return kernels::lod_start(line, lod);
}

double level_end(const QueryLevels& levels, int lod, int lods) {
  return levels.spread > 0 && lod + 1 < lods ? level_start(levels, lod + 1) : std::numeric_limits<double>::infinity();
}

void set_voxel(const QueryRay& ray, double at, std::int64_t v[3]) {
  for (int a = 0; a < 3; ++a) v[a] = std::int64_t(std::floor(ray.origin[a] + ray.direction[a] * at));
}

/// The distance and axis at which a ray leaves a box.
struct Exit {
  double at = std::numeric_limits<double>::infinity();
  int axis = 0;
};

Exit exit_of(const QueryRay& ray, const kernels::VoxelBox& box) {
  Exit exit;
  for (int a = 0; a < 3; ++a) {
    if (ray.direction[a] == 0) continue;
    const double side = double(ray.direction[a] > 0 ? box.max[a] : box.min[a]);
    const double at = (side - ray.origin[a]) / ray.direction[a];
    if (at < exit.at) exit = {at, a};
  }
  return exit;
}

/// Moves across the face into the next box, never across an edge. A box that shares only an edge is reached through
/// the boxes between.
void cross_face(const QueryRay& ray, const kernels::VoxelBox& box, const Exit& exit, QueryTraversal& walk) {
  walk.at = std::fmax(walk.at, exit.at);
  set_voxel(ray, walk.at, walk.v);
  for (int a = 0; a < 3; ++a) walk.v[a] = std::clamp(walk.v[a], box.min[a], box.max[a] - 1);
  walk.v[exit.axis] = ray.direction[exit.axis] > 0 ? box.max[exit.axis] : box.min[exit.axis] - 1;
}

void end_at_missing(std::uint32_t shard, double at, QueryTraversal& walk) {
  walk.nearest = {};
  walk.nearest.outcome = QueryOutcome::missing;
  walk.nearest.distance = at;
  walk.nearest.lod = walk.lod;
  walk.nearest.shard = shard;
  walk.finished = true;
}

}  // namespace

QueryTraversal start_walk(const QueryRay& ray, const QueryLevels& levels, const QueryPlaces& places) {
  QueryTraversal walk;
  const RayChord inside = chord_of(ray, places.window(), 0);
  if (inside.empty()) {
    walk.nearest.outcome = QueryOutcome::outside;
    walk.finished = true;
    return walk;
  }
  // Coarse voxels at the scene's border extend beyond its box.
  const int coarsest = levels.spread > 0 ? places.lods() - 1 : levels.finest;
  const RayChord chord = chord_of(ray, places.window(), kernels::power_of_two(coarsest));
  walk.at = chord.enter;
  walk.leave = chord.leave;
  walk.lod = levels.finest;
  while (walk.at >= level_end(levels, walk.lod, places.lods())) ++walk.lod;
  set_voxel(ray, walk.at, walk.v);
  return walk;
}

bool advance_walk(const QueryRay& ray, const QueryLevels& levels, const QueryPlaces& places, const QueryTrees& trees,
                  QueryTraversal& walk, QueryNeed& needed) {
  // A hit may lie up to a rim outside its window. A closer hit is possible until the ray reaches its distance.
  while (!walk.finished && walk.at <= walk.leave && walk.at < walk.nearest.distance) {
    const QueryPlace place = places.find(walk.lod, walk.v);
    const double begin = level_start(levels, walk.lod), end = level_end(levels, walk.lod, places.lods());
    if (place.kind == QueryPlace::Kind::unknown) {
      needed = {true, place.page, {}};
      return false;
    }
    if (place.kind == QueryPlace::Kind::lost) {
      end_at_missing(place.shard, walk.at, walk);
      break;
    }
    if (place.kind == QueryPlace::Kind::shard) {
      needed = {false, {}, {place.shard, walk.lod}};
      const QueryTrees::Found found = trees.find(needed.tree);
      if (found.unreadable) {
        end_at_missing(place.shard, walk.at, walk);
        break;
      }
      if (found.tree == nullptr) return false;
      const auto hit = found.tree->first_hit(ray, std::fmax(begin, ray.begin), std::fmin(end, ray.end), place.shard);
      if (hit && hit->distance < walk.nearest.distance) walk.nearest = *hit;
    }
    const Exit exit = exit_of(ray, place.box);
    if (exit.at < end) {
      cross_face(ray, place.box, exit, walk);
    } else {
      ++walk.lod;
      walk.at = end;
      set_voxel(ray, walk.at, walk.v);
    }
  }
  walk.finished = true;
  return true;
}

}  // namespace gigabake
