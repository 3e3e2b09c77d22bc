/// Stage 1 of a cell: the triangles that may overlap the window, transformed and snapped. If the transform mirrors, the
/// winding is restored.
#pragma once

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"
#include "kernels/body/voxelize/brick_triangle.h"
#include "kernels/cpu/unset_array.h"

namespace gigabake::kernels {

/// Returns the triangles in the order of parts and indices. Adds to `triangles`, `non_finite`, `zero_area`, `oversized`
/// and `bad_uv` of `stats`.
UnsetArray<WindowTriangle> window_triangles(const CellInput& input, const CellParameters& parameters,
                                            const ThreadPool& pool, CellStats& stats);

}  // namespace gigabake::kernels
