/// Export of one level's voxels to a binary point cloud.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/base/progress.h"

namespace gigabake {

/// Writes a binary_little_endian PLY. Position per vertex: double x y z (voxel centre, scene metres), int i j k
/// (lattice index at that lod: voxels of 2^lod from the lattice's 0,0,0). Attributes: uchar red green blue alpha, float
/// nx ny nz (0 if the scene has no normals).
/// Cells are in the scene's order. Levels from 4 up may not be aligned with their lattice; i j k is then rounded down.
/// Returns the number of voxels.
/// Cost    One level of one cell in memory.
/// Errors  InputError: no such level, damaged shards, disk full, or indices beyond 32 bits. No file is left behind.
std::uint64_t export_ply(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& ply,
                         const Progress& progress = {});

}  // namespace gigabake
