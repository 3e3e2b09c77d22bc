/// Levels coarser than the levels in the shards, derived for the export of scenes without overviews.
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
/// Colours and normals are means weighted by coverage. Colours are averaged in linear light. The class is the one with
/// the largest sum of coverages; of equal sums, the lowest.
/// Cost    Memory for all voxels of level owners.coarsest(), about 64 per cell of a terrain, and of the derived levels.
class DerivedLevels {
 public:
  struct Voxel {
    LevelIndex at{};
    std::array<std::uint8_t, 4> rgba{};
    std::array<std::int8_t, 2> normal{};
    VoxelClass voxel_class = no_class;
  };

  /// Computes the levels from owners.coarsest() + 1 to `coarsest`, if there are any.
  DerivedLevels(const PagedScene& scene, const LevelOwners& owners, int coarsest);

  bool has(int lod) const { return levels_.contains(lod); }
  const std::vector<Voxel>& level(int lod) const { return levels_.at(lod); }

 private:
  std::map<int, std::vector<Voxel>> levels_;
};

}  // namespace gigabake
