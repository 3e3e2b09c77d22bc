/// `gigabake export --to las`: the voxels of a level as a point cloud on the earth.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/progress.h"

namespace gigabake::app {

/// Writes the points in the coordinate system `crs` (open_map_frame()). Returns the number of voxels.
/// Errors  The errors of export_las() and open_map_frame().
std::uint64_t export_points(const std::string& scene_xml, int lod, const std::string& crs, const std::string& las,
                            const Progress& progress);

}  // namespace gigabake::app
