/// Voxels of one level as an OpenVDB file, where the library was there at configure.
#pragma once

#include <cstdint>
#include <filesystem>

#include "lattice/progress.h"

namespace gigabake {

/// Grids "density" (float fog volume: coverage from 0 to 1), "Cd" (Vec3s: colour in linear light) and, where the scene
/// has normals, "N" (Vec3s, unit vectors). Active are the voxels that exist; index (i, j, k) is the lattice index at
/// that lod; the transform takes it to the voxel's centre in scene metres. The origin on the earth is in the grids'
/// metadata.
/// Exact   rounding density · 255 and the sRGB of Cd gives the shards' bytes.
/// Cost    The library holds the grids in memory: 16 KB a brick. More than `most_bytes` of them are refused.
/// Errors  UsageError: this build has no OpenVDB. InputError: no such level, damaged shards, disk full, indices beyond
///         32 bits, too large. Nothing is left behind.
/// Returns the number of voxels.
std::uint64_t export_openvdb(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& vdb,
                             std::uint64_t most_bytes, const Progress& progress = {});

/// Half of the memory of this machine.
std::uint64_t openvdb_memory_bytes();

}  // namespace gigabake
