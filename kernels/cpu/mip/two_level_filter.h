/// The filter of MipFilter::thesis, which computes a level from the level two steps finer.
#pragma once

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"

namespace gigabake::kernels {

/// Returns the level two steps coarser than `fine`. A voxel exists if one of its 64 descendants in `fine` exists.
/// Exact   Depends only on the stored 8-bit voxels of `fine` (kernels/body/mip/two_level_filter.h).
/// Cost    Reads `fine` once.
Level two_level_filtered_level(const Level& fine, bool normals, const ThreadPool& pool);

}  // namespace gigabake::kernels
