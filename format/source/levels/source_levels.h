/// The levels at which sources are voxelized, from the voxel sizes that a scene .json states for them.
#pragma once

#include "core/octree/parameters.h"
#include "format/source/source.h"

namespace gigabake {

/// Sets TileRef::lod and the levels of TileRef::named_sizes of all tiles, and parameters.coarsest_lod. If a source, a
/// material or a node states a finer voxel size than the scene's, parameters.voxel_size_m becomes the finest of all.
/// Others then keep their size on a coarser level.
/// Exact   Does nothing if no source states a voxel size.
/// Errors  UsageError with file and key: a size is not the finest size times a power of two, or is coarser than a
///         cell's coarsest level; the errors of check().
void set_source_levels(SceneSources& sources, BakeParameters& parameters);

}  // namespace gigabake
