/// Removal of the voxels that a cell does not keep, before coarser levels are computed.
#pragma once

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"

namespace gigabake::kernels {

/// Removes all voxels of lod 0 that parameters.kept excludes, and bricks without voxels. Other voxels keep all bits.
/// Range   parameters.kept is not empty.
void clip(Level& level, const CellParameters& parameters, const ThreadPool& pool);

}  // namespace gigabake::kernels
