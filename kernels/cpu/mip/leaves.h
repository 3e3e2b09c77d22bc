/// Leaves of a level: voxels that were voxelized at this level, next to voxels that were filtered from finer ones.
#pragma once

#include "core/base/rules.h"
#include "kernels/body/cell.h"
#include "kernels/cpu/mip/levels.h"

namespace gigabake::kernels {

/// Adds leaves to level `lod`, which was filtered from the next finer level and has the surface data `surface`.
/// `leaves` has the form of lod 0: planes without directional coverage, or no planes.
/// Range   lod > 0. No voxel is in both levels.
/// Cost    Copies the level once.
void add_leaves(Level& level, LevelSurface& surface, const Level& leaves, int lod, MipFilter filter);

}  // namespace gigabake::kernels
