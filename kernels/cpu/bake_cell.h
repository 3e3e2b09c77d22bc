/// Baking of a cell on the threads of the host. This is the reference implementation: all other backends produce the
/// same bits.
#pragma once

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"

namespace gigabake::kernels {

CellVolume bake_cell(const CellInput& input, const CellParameters& parameters, const ThreadPool& pool);

/// Computes the volume of a cell from its voxels, as bake_cell() does after voxelization. `voxelized` has the voxels of
/// lod 0, and then the leaves of each level (kernels/cpu/mip/leaves.h), all in the form of lod 0.
/// Range   At least one level, at most as many as the cell has.
CellVolume volume_of(std::vector<Level> voxelized, const CellParameters& parameters, const ThreadPool& pool);

}  // namespace gigabake::kernels
