/// Traversal of a scene's shards by a ray, from its start to its first hit. It pauses if it needs data that is not
/// resident, and can be resumed later.
#pragma once

#include <cstdint>

#include "viewer/query/query_places.h"
#include "viewer/query/query_ray.h"
#include "viewer/query/query_tree.h"

namespace gigabake {

/// The levels that rays sample.
struct QueryLevels {
  int finest = 0;
  /// Growth of a ray's footprint per unit of distance. A ray samples the coarsest level whose voxels are not larger
  /// than its footprint, but no level finer than `finest`. 0: samples only `finest`.
  double spread = 0;
};

/// One level of one shard.
struct QueryTreeKey {
  std::uint32_t shard = 0;
  std::int32_t lod = 0;
  friend bool operator==(const QueryTreeKey&, const QueryTreeKey&) = default;
};

/// The data for which a traversal waits.
struct QueryNeed {
  bool is_page = false;
  PageKey page;  ///< page of the scene, if is_page
  QueryTreeKey tree;
};

/// Lookup of resident trees.
class QueryTrees {
 public:
  virtual ~QueryTrees() = default;

  struct Found {
    const QueryTree* tree = nullptr;  ///< null: not resident or unreadable
    bool unreadable = false;          ///< the tree can never be loaded
  };
  /// Returns the tree. Any number of threads may call it concurrently.
  virtual Found find(const QueryTreeKey& key) const = 0;
};

/// The state of a ray's traversal.
struct QueryTraversal {
  std::int64_t v[3] = {};  ///< lod-0 voxel at distance `at`
  double at = 0;
  double leave = 0;  ///< distance at which the ray leaves the scene
  std::int32_t lod = 0;
  bool finished = false;
  QueryHit nearest;  ///< so far; the result if finished
};

/// Starts a traversal.
/// Range   All numbers of the ray are finite except `end`, its direction is of unit length; levels.finest <
///         places.lods().
QueryTraversal start_walk(const QueryRay& ray, const QueryLevels& levels, const QueryPlaces& places);

/// Continues until the ray is finished and returns true. If a tree or page is not resident, sets `needed` to it and
/// returns false.
bool advance_walk(const QueryRay& ray, const QueryLevels& levels, const QueryPlaces& places, const QueryTrees& trees,
                  QueryTraversal& walk, QueryNeed& needed);

}  // namespace gigabake
