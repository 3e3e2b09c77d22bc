/// Baking of a cell on the threads of the host. This is the reference implementation: all other backends produce the
/// same bits.
#pragma once

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"

namespace gigabake::kernels {

CellVolume bake_cell(const CellInput& input, const CellParameters& parameters, const ThreadPool& pool);

/// Computes the volume of a cell from its voxels of lod 0, as bake_cell() does after voxelization.
CellVolume volume_of(Level finest, const CellParameters& parameters, const ThreadPool& pool);

}  // namespace gigabake::kernels
