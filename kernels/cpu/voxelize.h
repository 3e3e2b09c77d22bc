/// Stage 3 of a cell: a brick's triangles become its voxels.
#pragma once

#include <span>

#include "kernels/body/cell.h"
#include "kernels/cpu/bin.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// Appends the bricks of `pairs` (sorted by key, keys beyond those in `level`) that keep a visible voxel.
void voxelize(const CellInput& input, std::span<const WindowTriangle> triangles, const CellParameters& parameters,
              std::span<const Pair> pairs, const ThreadPool& pool, Level& level, CellStats& stats);

}  // namespace gigabake::kernels
