/// Stage 4 of a cell: every coarser level from the packed bricks of a level below it.
#pragma once

#include "kernels/body/cell.h"
#include "lattice/rules.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// The rasters of a level's voxels (kernels/body/facing.h); empty at lod 0 and without MipFilter::coverage.
using LevelRasters = std::vector<std::uint32_t>;

/// Adds to levels [0, n) those up to `lods`. A level's bricks are the unique parents of the level below; a voxel exists
/// where one of its eight children does. rasters: of the last level; then of the new last one.
/// Exact  Colour and normal depend on the stored 8-bit voxels of the level below and on how much of each shows;
///        coverage on those of lod 0. With MipFilter::thesis a level from 2 on depends on those of the level two below.
/// Cost   Each level is read once (with MipFilter::thesis twice) and written once (about a quarter of the one below,
/// for surfaces). With
///        MipFilter::coverage 12 bytes a voxel of lod 1 besides, and as much in all for each level above.
void add_coarser_levels(std::vector<Level>& levels, LevelRasters& rasters, int lods, MipFilter filter, bool normals,
                        const ThreadPool& pool);

/// Leaves alpha alone, the largest of the three, to say what a voxel covers.
void drop_facing(std::vector<Level>& levels);

}  // namespace gigabake::kernels
