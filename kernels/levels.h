/// Stage 4 of a cell: every coarser level from the packed bricks of the level below it.
#pragma once

#include "kernels/cell.h"

namespace gigabake::kernels {

/// The level above `fine`: its bricks are the unique parents, a voxel exists where one of its eight children does.
/// Exact  Depends on the stored 8-bit voxels of `fine` alone.
/// Cost   One read of `fine`, one write of the result (about a quarter for surfaces).
Level coarser_level(const Level& fine, MipFilter filter, bool normals, const CpuPolicy& policy);

}  // namespace gigabake::kernels
