/// Levels above those that a scene's shards have, for scenes that were baked without parents.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "format/export/level_owners.h"
#include "format/export/shard_levels.h"
#include "format/export/voxel_tiling.h"

namespace gigabake {

/// Each level made of the one below it: coverage as in the bake's `coverage` levels, colour and normal weighted by it,
/// colour in linear light. Cost  one voxel in some 64 of a cell's edge squared in memory.
class MadeLevels {
 public:
  struct Voxel {
    LevelIndex at{};
    std::array<std::uint8_t, 4> rgba{};
    std::array<std::int8_t, 2> normal{};
  };

  /// The levels from owners.coarsest() + 1 to `coarsest`; none where that is not above it.
  MadeLevels(const PagedScene& scene, const LevelOwners& owners, int coarsest);

  bool has(int lod) const { return levels_.contains(lod); }
  const std::vector<Voxel>& level(int lod) const { return levels_.at(lod); }

 private:
  std::map<int, std::vector<Voxel>> levels_;
};

}  // namespace gigabake
