/// Check that the sources fit the classes that a scene .json states for them.
#pragma once

#include <vector>

#include "format/job/tile_scan.h"
#include "format/source/source.h"

namespace gigabake {

/// Checks the scans of all tiles. A material's name that no tile of the source has is an error, unless a tile could not
/// be read or an area of interest leaves out tiles.
/// Range   `scans` has one entry per tile, in their order.
/// Errors  UsageError with file and key: a tile refused its classes, or a name is unknown.
void expect_classes(const std::vector<TileScan>& scans, const SceneSources& sources);

}  // namespace gigabake
