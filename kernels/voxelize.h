/// Stage 3 of a cell: a brick's triangles become its voxels.
#pragma once

#include <vector>

#include "kernels/bin.h"
#include "kernels/cell.h"

namespace gigabake::kernels {

/// Appends the bricks of `pairs` (sorted by key, keys beyond those in `level`) that keep a visible voxel.
void voxelize(const CellInput& input, const std::vector<WindowTriangle>& triangles, const CellParameters& parameters,
              const std::vector<Pair>& pairs, const CpuPolicy& policy, Level& level, CellStats& stats);

}  // namespace gigabake::kernels
