/// Stage 4 of a cell: all coarser levels, from the packed bricks of finer levels.
#pragma once

#include <span>

#include "core/base/rules.h"
#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"
#include "kernels/body/mip/patch.h"

namespace gigabake::kernels {

/// The surface data of a level, which the next coarser level needs in addition to voxels. It is empty at lod 0 and
/// without MipFilter::coverage.
struct LevelSurface {
  std::vector<std::uint32_t>
      rasters;  ///< coverage masks of all voxels, in order (kernels/body/mip/directional_coverage.h)
  std::vector<SurfaceMoments> patches;  ///< moments of all voxels (kernels/body/mip/patch.h); empty without normals
};

/// Adds levels until there are `lods` levels. The bricks of a level are the unique parents of the next finer level's
/// bricks. A voxel exists if one of its eight children exists. `surface` must be the surface data of the last level. It
/// is replaced by the surface data of the new last level.
/// Exact   Colour and normal depend on the stored 8-bit voxels of the next finer level and on their visible fractions.
///         Coverage depends on the voxels of lod 0. If `filter` is MipFilter::thesis, levels from 2 on depend on the
///         stored voxels of the level two steps finer.
/// Leaves  `leaves` has the voxels that were voxelized at their own level, by level: entry k is added to level k, if k
///         is at least 1 (kernels/cpu/mip/leaves.h). MipFilter::thesis accepts none.
/// Cost    Each level is read once (MipFilter::thesis: twice) and written once. On a surface, a level has about a
///         quarter of the voxels of the next finer level. MipFilter::coverage takes 20 more bytes per voxel of lod 1,
///         and at most about the same total for each coarser level.
void add_coarser_levels(std::vector<Level>& levels, LevelSurface& surface, int lods, MipFilter filter, bool normals,
                        const ThreadPool& pool, std::span<const Level> leaves = {});

/// Removes the directional coverage of all levels. Only alpha remains, which is the max of the three coverages.
void drop_directional_coverage(std::vector<Level>& levels);

}  // namespace gigabake::kernels
