/// The shard of an overview, generated without the cells below it: a height field on its finest level, and coarser
/// levels derived from it. It serves tests that view only overview levels, of scenes with more cells than can be baked.
#pragma once

#include <functional>

#include "format/job/cell_job.h"
#include "format/shard/shard.h"

namespace gigabake {

/// The height of a surface in lod-0 voxels.
using SurfaceHeight = std::function<double(double x, double y)>;

/// Returns the shard of an opaque surface that faces up. The colour of the surface changes from brick to brick. If the
/// surface misses the window, the shard contains the voxel at the window's middle.
/// Cost    About 0.2 µs per voxel.
Shard painted_overview(const CellJob& overview, const SurfaceHeight& height, double voxel_size_m);

}  // namespace gigabake
