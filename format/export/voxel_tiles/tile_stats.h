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

/// The tiles of an export and their weights. A tile's weight estimates its cost: the number of bricks in the tile and
/// its padding.
using TileWeights = std::map<TilePlace, std::uint64_t>;

/// Statistics from the node tables of the shards. Each rank reads the shards of its partition and gets the results of
/// all ranks.
/// Errors  InputError from every member: a shard is damaged or missing. Stopped: the export was cancelled.
class TileStats {
 public:
  TileStats(const PagedScene& scene, const LevelOwners& owners, const ExportTeam& team, const ThreadPool& pool,
            const Progress& progress)
      : scene_(scene), owners_(owners), team_(team), pool_(pool), progress_(progress) {}

  /// Returns the bounding box of all bricks with voxels of level `lod`, in voxels of level 0.
  Box3i64 bounds(int lod) const;
  /// Returns the tiles of all levels. `made` has the levels that are derived.
  /// Errors  InputError also if the scene has overviews and a tile lacks its parent tile.
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
