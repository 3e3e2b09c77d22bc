/// A ray's way through the shards of a scene, from the one it begins in to the one where it meets something. What it
/// needs and is not here stops it; it goes on from there when it is.
#pragma once

#include <cstdint>

#include "viewer/query/query_places.h"
#include "viewer/query/query_ray.h"
#include "viewer/query/query_tree.h"

namespace gigabake {

/// Which levels rays look at.
struct QueryLevels {
  int finest = 0;
  /// How much wider a ray's footprint is after a unit of its way: it meets voxels of the coarsest level that are no
  /// wider than that, but never finer ones than `finest`. 0: those of `finest` all the way.
  double spread = 0;
};

/// One level of one shard.
struct QueryTreeKey {
  std::uint32_t shard = 0;
  std::int32_t lod = 0;
  friend bool operator==(const QueryTreeKey&, const QueryTreeKey&) = default;
};

/// What a walk waits for.
struct QueryNeed {
  bool is_page = false;
  PageKey page;  ///< of the scene, or
  QueryTreeKey tree;
};

/// Where a walk finds trees.
class QueryTrees {
 public:
  virtual ~QueryTrees() = default;

  struct Found {
    const QueryTree* tree = nullptr;  ///< null: not here, or
    bool unreadable = false;          ///< it will never be
  };
  /// Any number of threads.
  virtual Found find(const QueryTreeKey& key) const = 0;
};

/// What is left of a ray on its way.
struct QueryWalk {
  std::int64_t v[3] = {};  ///< the lod-0 voxel that it comes to at `at`
  double at = 0;
  double leave = 0;  ///< it is behind the scene
  std::int32_t lod = 0;
  bool finished = false;
  QueryHit nearest;  ///< so far; the answer where it is finished
};

/// Range   The ray's numbers are finite but for `end`, its direction is of length 1; levels.finest < places.lods().
QueryWalk start_walk(const QueryRay& ray, const QueryLevels& levels, const QueryPlaces& places);

/// Goes on until the walk is finished, or until a tree or a page of the scene is needed that is not here: then returns
/// false, and which.
bool walk_on(const QueryRay& ray, const QueryLevels& levels, const QueryPlaces& places, const QueryTrees& trees,
             QueryWalk& walk, QueryNeed& needed);

}  // namespace gigabake
