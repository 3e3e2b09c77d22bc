/// Ends branches of a cell where leaves describe all finer levels within a bound.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"

namespace gigabake::kernels {

/// Removes bricks that the octant above them describes within `codes` (kernels/body/mip/branch_error.h). An octant of
/// level k, at most max_ended_lod, ends if each of its voxels describes all voxels below it, on all finer levels. All
/// octants below it must end too. prune() marks it as leaves.
/// Exact   An octant depends only on its voxels and on the voxels below it. Levels keep all other voxels. codes = 0
///         removes nothing.
/// Cost    Reads each voxel up to max_ended_lod times.
void end_branches(std::vector<Level>& levels, std::uint32_t codes, const ThreadPool& pool);

}  // namespace gigabake::kernels
