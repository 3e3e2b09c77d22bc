/// Lookup of the shards that natively hold a level: cells for their own levels, overviews for those above.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/math/box3.h"
#include "format/scene/paged_scene.h"

namespace gigabake {

/// A shard and its native levels on the lattice. Its other levels are duplicates.
struct LevelOwner {
  SceneCell shard;
  int finest = 0, coarsest = 0;
};

/// Finds native levels by lod. Borrows the scene. Thread-safe.
/// Errors  InputError: a page cannot be read.
class LevelOwners {
 public:
  explicit LevelOwners(const PagedScene& scene);

  /// Returns the coarsest level that the whole scene has.
  int coarsest() const { return coarsest_; }
  /// Returns whether the scene has overviews.
  bool has_overviews() const { return scene_.totals().overviews != 0; }
  /// Returns the owners of a level whose windows overlap the box (voxels of level 0), in the same order at every call.
  std::vector<LevelOwner> of(int lod, const Box3i64& box) const;
  /// Visits the owners of partition `share` of `shares` that have a level from `finest` to `coarsest`. Partitions are
  /// disjoint and complete.
  /// Cost    One page of the scene in memory; pages of other partitions are not read.
  void for_each(int finest, int coarsest, std::size_t share, std::size_t shares,
                const std::function<void(std::vector<LevelOwner>)>& visit) const;

 private:
  static LevelOwner of(const SceneCell& shard);

  const PagedScene& scene_;
  int coarsest_ = 0;
};

}  // namespace gigabake
