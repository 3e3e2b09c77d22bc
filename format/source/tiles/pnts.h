/// 3D Tiles 1.0 "Point Cloud": the number of its points, which are not baked.
#pragma once

#include <filesystem>

#include "format/source/source.h"
#include "format/source/source_files.h"

namespace gigabake {

/// Returns an entry that reports the point cloud in `tile` as skipped, under the name `name`. The number of points is
/// POINTS_LENGTH of the feature table, or 0 if POINTS_LENGTH cannot be read.
/// Cost    Reads headers.
SkippedSource skipped_points(const TileRef& tile, const SourceFiles& files, const std::string& name);

}  // namespace gigabake
