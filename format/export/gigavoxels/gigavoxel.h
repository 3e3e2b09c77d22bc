/// Export to the thesis's formats: a paged scene of GigaVoxels octrees in a folder (docs/format-gigavoxels.md).
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/base/progress.h"

namespace gigabake {

enum class GigavoxelTreeFile { xml, binary };

/// Writes the levels from `lod` up into a new folder: scene.gvp lists the cells. Each cell has tree.gvx or tree.gvo,
/// and one brick file voxels_D.gvb per depth D of its octree. Bricks have a border of one voxel: the neighbouring
/// voxels of the same cell. The border is empty outside of the cell. Returns the number of voxels of level `lod`.
/// Exact   Colours are the shards' bytes. Gradients are rounded to one byte per component.
/// Cost    Holds at most two levels of one cell in memory.
/// Errors  InputError: the level does not exist, a shard is damaged, the disk is full, or the folder exists. No file is
///         left behind.
std::uint64_t export_gigavoxel(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& folder,
                               GigavoxelTreeFile kind, const Progress& progress = {});

}  // namespace gigabake
