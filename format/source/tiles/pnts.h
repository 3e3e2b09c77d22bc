/// 3D Tiles 1.0 "Point Cloud": how much of it there is, since nothing of it is baked.
#pragma once

#include <filesystem>

#include "format/source/source.h"
#include "format/source/source_files.h"

namespace gigabake {

/// Of the content `name`, which is a point cloud in `tile`: a line for whoever wonders where it went, with
/// POINTS_LENGTH of its feature table where that can be read. Cost  Reads headers.
SkippedSource skipped_points(const TileRef& tile, const SourceFiles& files, const std::string& name);

}  // namespace gigabake
