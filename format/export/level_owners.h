/// Which shard of a scene holds a level of a place: a cell its own levels, parents those above it.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "format/scene/paged_scene.h"

namespace gigabake {

/// A shard and the levels of the lattice that are its own. What else it may hold is a copy.
struct LevelOwner {
  SceneCell shard;
  int finest = 0, coarsest = 0;
};

/// Levels by their lod, whatever a shard holds besides. Borrows the scene. Any number of threads may use one.
/// Errors  InputError of a page that cannot be read.
class LevelOwners {
 public:
  explicit LevelOwners(const PagedScene& scene);

  /// The coarsest level that the whole scene has.
  int coarsest() const { return coarsest_; }
  /// Whether there are shards for the levels above the cells'.
  bool has_parents() const { return scene_.totals().parents != 0; }
  /// Owners of a level whose windows overlap the box (voxels of level 0), the same order at every call.
  std::vector<LevelOwner> of(int lod, const LatticeBox& box) const;
  /// Every owner of some level from `finest` to `coarsest` that is the `share`-th of `shares`: each is some share's.
  /// Cost  one page of the scene in memory; the pages of other shares are not read.
  void for_each(int finest, int coarsest, std::size_t share, std::size_t shares,
                const std::function<void(std::vector<LevelOwner>)>& visit) const;

 private:
  static LevelOwner of(const SceneCell& shard);

  const PagedScene& scene_;
  int coarsest_ = 0;
};

}  // namespace gigabake
