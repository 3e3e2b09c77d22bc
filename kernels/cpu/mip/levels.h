/// Stage 4 of a cell: all coarser levels, from the packed bricks of finer levels.
#pragma once

#include "core/base/rules.h"
#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"
#include "kernels/body/mip/patch.h"

namespace gigabake::kernels {

/// The input of coarser levels in addition to voxels. Empty at lod 0 and without MipFilter::coverage.
struct LevelSurface {
  std::vector<std::uint32_t> rasters;   ///< coverage masks of all voxels, in order (kernels/body/mip/facing.h)
  std::vector<SurfaceMoments> patches;  ///< (kernels/body/mip/patch.h); empty without normals
};

/// Adds levels until there are `lods`. A level's bricks are the unique parents of the bricks below. A voxel exists if
/// one of its eight children exists. Parameter surface: input of the last level; replaced by that of the new last
/// level.
/// Exact   Colour and normal depend on the stored 8-bit voxels of the level below and on their visible fractions.
///         Coverage depends on the voxels of lod 0. If `filter` is MipFilter::thesis, levels from 2 on depend on the
///         stored voxels two levels below.
/// Cost    Each level is read once (MipFilter::thesis: twice) and written once. A surface's level is about a quarter of
///         the level below. MipFilter::coverage takes 20 more bytes per voxel of lod 1, and about the same amount for
///         each level above.
void add_coarser_levels(std::vector<Level>& levels, LevelSurface& surface, int lods, MipFilter filter, bool normals,
                        const ThreadPool& pool);

/// Removes the directional coverage; alpha, the max of the three coverages, remains as the only coverage.
void drop_facing(std::vector<Level>& levels);

}  // namespace gigabake::kernels
