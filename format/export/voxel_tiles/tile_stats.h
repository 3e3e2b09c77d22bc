/// The tiles of an export, determined from the shards' node tables before any voxel is read.
#pragma once

#include <cstdint>
#include <map>

#include "core/base/progress.h"
#include "core/base/thread_pool.h"
#include "core/math/box3.h"
#include "format/export/derived_levels.h"
#include "format/export/level_owners.h"
#include "format/export/voxel_tiles/voxel_tileset.h"
#include "format/export/voxel_tiles/voxel_tiling.h"

namespace gigabake {

/// Tiles that contain a brick or have one in their padding, with the number of such bricks as their cost.
using TileWeights = std::map<TilePlace, std::uint64_t>;

/// Reads the node tables of this rank's partition of the shards. Every rank gets the results of all ranks.
/// Errors  InputError from all members: damaged or missing shards. Stopped.
class TileStats {
 public:
  TileStats(const PagedScene& scene, const LevelOwners& owners, const ExportTeam& team, const ThreadPool& pool,
            const Progress& progress)
      : scene_(scene), owners_(owners), team_(team), pool_(pool), progress_(progress) {}

  /// Returns the bounding box of the bricks that hold a level's voxels, in voxels of level 0.
  Box3i64 bounds(int lod) const;
  /// Errors  InputError also if a scene with overviews lacks one above a tile.
  TileWeights tiles(const VoxelTiling& tiling, const DerivedLevels& made) const;

 private:
  template <class LevelsOf, class Visit>
  void for_each_own_level(int finest, int coarsest, const LevelsOf& levels_of, const Visit& visit) const;
  void expect_whole_levels(const TileWeights& tiles, const VoxelTiling& tiling) const;

  const PagedScene& scene_;
  const LevelOwners& owners_;
  const ExportTeam& team_;
  const ThreadPool& pool_;
  const Progress& progress_;
};

}  // namespace gigabake
