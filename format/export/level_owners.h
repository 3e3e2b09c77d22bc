/// Lookup of the shards that own a level. A cell owns all its levels; an overview owns the levels that are not
/// duplicated levels of its children.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/math/box3.h"
#include "format/scene/paged_scene.h"

namespace gigabake {

/// A shard and the range of levels that it owns, as levels of the lattice. Its other levels are duplicated levels.
struct LevelOwner {
  SceneCell shard;
  int finest = 0, coarsest = 0;
};

/// The owners of all levels of a scene. Borrows the scene. Thread-safe.
/// Errors  InputError: a page of the scene cannot be read.
class LevelOwners {
 public:
  explicit LevelOwners(const PagedScene& scene);

  /// Returns the coarsest level that exists in the whole scene.
  int coarsest() const { return coarsest_; }
  bool has_overviews() const { return scene_.totals().overviews != 0; }
  /// Returns the owners of level `lod` whose windows overlap `box` (in voxels of level 0). The order is the same at
  /// every call.
  std::vector<LevelOwner> of(int lod, const Box3i64& box) const;
  /// Visits the owners of levels from `finest` to `coarsest` in partition `share` of `shares`. Each owner is in exactly
  /// one partition. Calls `visit` with the owners of one page at a time.
  /// Cost    Holds one page of the scene in memory. Does not read pages of other partitions.
  void for_each(int finest, int coarsest, std::size_t share, std::size_t shares,
                const std::function<void(std::vector<LevelOwner>)>& visit) const;

 private:
  static LevelOwner of(const SceneCell& shard);

  const PagedScene& scene_;
  int coarsest_ = 0;
};

}  // namespace gigabake
