/// Export of one level's voxels to a NanoVDB file.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/base/progress.h"

namespace gigabake {

/// Writes two grids of class VoxelVolume: "rgba" (RGBA8: sRGB colour, coverage) and, if the scene has normals, "normal"
/// (Vec3f, unit vectors). Existing voxels are active. The file is not compressed (docs/format.md). Returns the number
/// of voxels.
/// Space   Index (i, j, k) is the lattice index at level `lod`. The grid's map converts it to the voxel's lowest corner
///         in scene metres.
/// Exact   Colours are the shards' bytes. Normals are rounded to the nearest floats.
/// Cost    Holds one level of one cell and at most 48 bytes per brick in memory. Reads the shards twice.
/// Errors  InputError: the level does not exist, a shard is damaged, the disk is full, or an index exceeds 32 bits. No
///         file is left behind.
std::uint64_t export_nanovdb(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& nvdb,
                             const Progress& progress = {});

}  // namespace gigabake
