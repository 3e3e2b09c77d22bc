/// A scene as voxel 3D Tiles for CesiumJS.
#pragma once

#include <cstdint>
#include <filesystem>

#include "lattice/progress.h"

namespace gigabake {

/// A new folder: tileset.json, one implicit oct-tree over the whole scene (subtrees/), a binary glTF for each 8³ voxels
/// of each level from `lod` on (tiles/). Levels above the cells' coarsest are made of it, up to one tile
/// (docs/format.md). A scene with an origin stands on the earth.
/// Exact   colours are the shards' bytes, normals the nearest floats.
/// Cost    One level of one cell and at most 24 bytes a tile in memory.
/// Errors  InputError: no such level, damaged shards, disk full, the folder is there already. Nothing is left behind.
/// Returns the number of voxels of level `lod`.
std::uint64_t export_3dtiles(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& folder,
                             const Progress& progress = {});

}  // namespace gigabake
