/// 3D Tiles 1.0 "Point Cloud": number of points, which are not baked.
#pragma once

#include <filesystem>

#include "format/source/source.h"
#include "format/source/source_files.h"

namespace gigabake {

/// Returns the entry for the content `name`, a point cloud in `tile`, so that the user learns why it is missing. The
/// entry has POINTS_LENGTH of the feature table if that can be read.
/// Cost    Reads headers.
SkippedSource skipped_points(const TileRef& tile, const SourceFiles& files, const std::string& name);

}  // namespace gigabake
