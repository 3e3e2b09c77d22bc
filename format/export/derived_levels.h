/// Derived levels above those in the shards, for scenes baked without overviews.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "format/export/level_owners.h"
#include "format/export/shard_levels.h"
#include "format/export/voxel_tiles/voxel_tiling.h"

namespace gigabake {

/// Levels that are each computed from the next finer level. Coverage is computed as in the bake's `coverage` levels.
/// Colour and normal are weighted by coverage; colour in linear light.
/// Cost    Memory: about one voxel per 64 voxels of a cell's squared edge.
class DerivedLevels {
 public:
  struct Voxel {
    LevelIndex at{};
    std::array<std::uint8_t, 4> rgba{};
    std::array<std::int8_t, 2> normal{};
  };

  /// Computes levels from owners.coarsest() + 1 to `coarsest`; none if `coarsest` is not above owners.coarsest().
  DerivedLevels(const PagedScene& scene, const LevelOwners& owners, int coarsest);

  bool has(int lod) const { return levels_.contains(lod); }
  const std::vector<Voxel>& level(int lod) const { return levels_.at(lod); }

 private:
  std::map<int, std::vector<Voxel>> levels_;
};

}  // namespace gigabake
