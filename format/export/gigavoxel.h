/// The thesis's own formats: a paged scene of GigaVoxels oct-trees, in folders of files (docs/format-gigavoxels.md).
#pragma once

#include <cstdint>
#include <filesystem>

#include "lattice/progress.h"

namespace gigabake {

enum class GigavoxelTreeFile { xml, binary };

/// A new folder: scene.gvp lists the cells, each with tree.gvx or tree.gvo and a brick file voxels_D.gvb for each
/// depth. The levels from `lod` on. Bricks have a border of one voxel: neighbours inside the cell, empty outside of it.
/// Exact   colours; gradients are rounded to a byte a component.
/// Cost    One level of one cell in memory. Returns the number of voxels of level `lod`.
/// Errors  InputError: no such level, damaged shards, disk full, the folder is there already. Nothing is left behind.
std::uint64_t export_gigavoxel(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& folder,
                               GigavoxelTreeFile kind, const Progress& progress = {});

}  // namespace gigabake
