/// Stage 4 of a cell: every coarser level from the packed bricks of a level below it.
#pragma once

#include "kernels/body/cell.h"
#include "kernels/body/patch.h"
#include "lattice/rules.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// What coarser levels are made of, besides voxels. Empty at lod 0 and without MipFilter::coverage.
struct LevelSurface {
  std::vector<std::uint32_t> rasters;  ///< of the level's voxels, one after the other (kernels/body/facing.h)
  std::vector<Patch> patches;          ///< (kernels/body/patch.h); empty without normals
};

/// Adds to levels [0, n) those up to `lods`. A level's bricks are the unique parents of the level below; a voxel exists
/// where one of its eight children does. surface: of the last level; then of the new last one.
/// Exact  Colour and normal depend on the stored 8-bit voxels of the level below and on how much of each shows;
///        coverage on those of lod 0. With MipFilter::thesis a level from 2 on depends on those of the level two below.
/// Cost   Each level is read once (with MipFilter::thesis twice) and written once (about a quarter of the one below,
/// for surfaces). With
///        MipFilter::coverage 20 bytes a voxel of lod 1 besides, and about as much in all for each level above.
void add_coarser_levels(std::vector<Level>& levels, LevelSurface& surface, int lods, MipFilter filter, bool normals,
                        const ThreadPool& pool);

/// Leaves alpha alone, the largest of the three, to say what a voxel covers.
void drop_facing(std::vector<Level>& levels);

}  // namespace gigabake::kernels
