/// A level from the one two below it, with MipFilter::thesis.
#pragma once

#include "kernels/body/cell.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// The level two above `fine`; a voxel exists where one of the 64 of it in `fine` does.
/// Exact  The stored 8-bit voxels of `fine` decide (kernels/body/mip_of_64.h).
/// Cost   Reads `fine` once.
Level level_of_64(const Level& fine, bool normals, const ThreadPool& pool);

}  // namespace gigabake::kernels
