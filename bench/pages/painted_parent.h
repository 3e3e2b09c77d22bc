/// A parent's shard without the cells below it: a surface of one height a column, painted on its finest level and taken
/// up from there. For scenes of more cells than can be baked, of which somebody looks at the levels above.
#pragma once

#include <functional>

#include "format/job/cell_job.h"
#include "format/shard/shard.h"

namespace gigabake {

/// Lod-0 voxels.
using SurfaceHeight = std::function<double(double x, double y)>;

/// Opaque, facing up and striped by the level's grid. Cost  some 0.2 µs a voxel.
/// Range  Where the surface misses the window, the parent has the voxel at its middle.
Shard painted_parent(const CellJob& parent, const SurfaceHeight& height, double voxel_size_m);

}  // namespace gigabake
