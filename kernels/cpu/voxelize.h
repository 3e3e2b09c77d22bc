/// Stage 3 of a cell: a brick's triangles become its voxels.
#pragma once

#include <vector>

#include "kernels/body/cell.h"
#include "kernels/cpu/bin.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// Appends the bricks of `pairs` (sorted by key, keys beyond those in `level`) that keep a visible voxel.
void voxelize(const CellInput& input, const std::vector<WindowTriangle>& triangles, const CellParameters& parameters,
              const std::vector<Pair>& pairs, const ThreadPool& pool, Level& level, CellStats& stats);

}  // namespace gigabake::kernels
