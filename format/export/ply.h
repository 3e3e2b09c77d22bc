/// Voxels of one level as a binary point cloud.
#pragma once

#include <cstdint>
#include <filesystem>

#include "lattice/progress.h"

namespace gigabake {

/// binary_little_endian PLY; per vertex: double x y z (voxel centre, scene metres), int i j k (lattice index at that
/// lod: voxels of 2^lod from the lattice's 0,0,0), uchar red green blue alpha, float nx ny nz (0 where the scene has no
/// normals). Cells in the scene's order. Levels from 4 on may stand off their lattice; i j k is then rounded down.
/// Cost    One level of one cell in memory. Returns the number of voxels.
/// Errors  InputError: no such level, damaged shards, disk full, indices beyond 32 bits. Nothing is left behind.
std::uint64_t export_ply(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& ply,
                         const Progress& progress = {});

}  // namespace gigabake
