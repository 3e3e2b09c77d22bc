/// Stage 3 of a cell: computes the voxels of each brick from its triangles.
#pragma once

#include <span>

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"
#include "kernels/cpu/voxelize/bin.h"

namespace gigabake::kernels {

/// Appends the bricks of `pairs` that have a visible voxel to `level`.
/// Range   Pairs are sorted by key. Their keys are greater than all keys in `level`.
void voxelize(const CellInput& input, std::span<const WindowTriangle> triangles, const CellParameters& parameters,
              std::span<const Pair> pairs, const ThreadPool& pool, Level& level, CellStats& stats);

}  // namespace gigabake::kernels
