/// Check that the sources fit the classes and voxel sizes that a scene .json states for names in them.
#pragma once

#include <vector>

#include "format/job/tile_scan.h"
#include "format/source/source.h"

namespace gigabake {

/// Checks the scans of all tiles. A name of a material or node that no tile of the source has is an error, unless a
/// tile could not be read or an area of interest leaves out tiles.
/// Range   `scans` has one entry per tile, in their order.
/// Errors  UsageError with file and key: a tile refused its classes or voxel sizes, or a name is unknown.
void expect_stated_names(const std::vector<TileScan>& scans, const SceneSources& sources);

}  // namespace gigabake
