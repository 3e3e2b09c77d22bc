/// Results of lookups that one thread uses again during a pass of the pager.
#pragma once

#include <cstdint>

#include "viewer/stream/shard_map.h"

namespace gigabake {

inline constexpr std::uint32_t no_shard = 0xffffffffu;

/// The latest path down the nodes of a shard. The next lookup starts where its path diverges from this path.
struct NodePath {
  std::uint32_t shard = no_shard;
  std::int32_t lowest = 0;                           ///< level at which the path ended
  Vec3i64 v{};                                       ///< target of the path: lod-0 voxels from the shard's corner
  const NodeRow* node[kernels::max_cast_lods] = {};  ///< by level, from `lowest` up
  std::int32_t extent_lod = -1;                      ///< level of `extent`; -1: none
  ShardExtent extent;                                ///< latest shard of provider 0 (ShardMap::find())
};

/// The cache of one thread. It is valid for one pass of the pager.
struct LookupCache {
  FoundPages pages;
  NodePath path;
};

}  // namespace gigabake
