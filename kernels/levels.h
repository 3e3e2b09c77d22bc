/// Stage 4 of a cell: every coarser level from the packed bricks of the level below it.
#pragma once

#include "kernels/cell.h"

namespace gigabake::kernels {

/// All levels above `finest`, up to the one of the window's single brick. A level's bricks are the unique parents of
/// the level below; a voxel exists where one of its eight children does. Exact  Colour and normal depend on the stored
/// 8-bit voxels of the level below and on how much of each shows; coverage
///        on those of `finest` (kernels/facing.h).
/// Cost   Each level is read once and written once (about a quarter of the one below, for surfaces). With
///        MipFilter::coverage 12 bytes a voxel of lod 1 besides, and as much in all for each level above.
std::vector<Level> coarser_levels(const Level& finest, int lods, MipFilter filter, bool normals,
                                  const CpuPolicy& policy);

}  // namespace gigabake::kernels
