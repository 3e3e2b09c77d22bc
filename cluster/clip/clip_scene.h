/// A part of a baked scene as a separate scene, for commands that read only an area of interest.
#pragma once

#include <filesystem>
#include <memory>

#include "core/base/progress.h"
#include "format/area/area.h"

namespace gigabake {

/// Writes the part of the scene that lies inside the area to `folder`, and returns its scene.xml. Shards of cells that
/// are wholly inside become symbolic links. Shards outside are not opened. Cells on the border are computed again from
/// their voxels of lod 0 that are inside, and overviews from these cells.
/// Exact   The voxels equal a bake with the area if the bake has max_error 0.
/// Errors  UsageError: the area lies on the earth and the scene does not, or no voxel is inside the area. InputError:
///         the scene or a shard cannot be read, or `folder` cannot be written. Stopped.
std::filesystem::path clip_scene(const std::filesystem::path& scene_xml, const std::shared_ptr<const Area>& area,
                                 const std::filesystem::path& folder, int threads, const Progress& progress);

}  // namespace gigabake
