/// Which tiles an export has: told by the node tables of shards, before a voxel is read.
#pragma once

#include <cstdint>
#include <map>

#include "format/export/export_team.h"
#include "format/export/level_owners.h"
#include "format/export/made_levels.h"
#include "format/export/voxel_tiling.h"
#include "lattice/progress.h"
#include "lattice/thread_pool.h"

namespace gigabake {

/// Tiles with a brick in them or so near that it shows there, and how many: what they cost.
using TileWeights = std::map<TilePlace, std::uint64_t>;

/// Reads the node tables of this rank's share of the shards. Every rank gets all that the ranks found.
/// Errors (all)  InputError: damaged or missing shards. Stopped.
class TileStats {
 public:
  TileStats(const PagedScene& scene, const LevelOwners& owners, const ExportTeam& team, const ThreadPool& pool,
            const Progress& progress)
      : scene_(scene), owners_(owners), team_(team), pool_(pool), progress_(progress) {}

  /// The smallest box of bricks that holds the voxels of a level, in voxels of level 0.
  LatticeBox bounds(int lod) const;
  /// Errors  also InputError: a scene that has parents lacks one over a tile.
  TileWeights tiles(const VoxelTiling& tiling, const MadeLevels& made) const;

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
