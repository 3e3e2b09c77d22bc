/// Export of one level's voxels to an OpenVDB file, if CMake found the library.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/base/progress.h"

namespace gigabake {

/// Writes one level as grids; existing voxels are active. The grid "density" is a float fog volume: coverage from 0 to
/// 1. The grid "Cd" has the colour in linear light (Vec3s). The grid "N" has unit vectors (Vec3s); it is written only
/// if the scene has normals. The metadata of each grid has the scene's origin on the earth, if there is one. Returns
/// the number of voxels.
/// Space   Index (i, j, k) is the lattice index at level `lod`. The grid's transform converts it to the voxel's centre
///         in scene metres.
/// Exact   The shards' bytes result from rounding: density · 255 for the coverage, and the sRGB values of Cd for the
///         colour.
/// Cost    The library holds the grids in memory: 16 KB per brick. Grids of more than `max_bytes` are rejected.
/// Errors  UsageError: this build has no OpenVDB. InputError: the level does not exist, a shard is damaged, the disk is
///         full, an index exceeds 32 bits, or the grids exceed `max_bytes`. No file is left behind.
std::uint64_t export_openvdb(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& vdb,
                             std::uint64_t max_bytes, const Progress& progress = {});

/// Returns half of this machine's memory in bytes; 0 if this build has no OpenVDB.
std::uint64_t openvdb_memory_bytes();

}  // namespace gigabake
