/// Export of one level's voxels to an OpenVDB file, if the library was found by CMake.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/base/progress.h"

namespace gigabake {

/// Writes one level as grids; existing voxels are active. The grid "density" is a float fog volume: coverage from 0 to
/// 1. The grid "Cd" has the colour in linear light (Vec3s). The grid "N" has unit vectors (Vec3s); it is written only
/// if the scene has normals. The grids' metadata have the origin on the earth. Returns the number of voxels.
/// Space   Index (i, j, k) is the lattice index at that lod; the transform yields the voxel's centre in scene metres.
/// Exact   Rounding density · 255 and the sRGB of Cd yields the shards' bytes.
/// Cost    The library holds the grids in memory: 16 KB per brick. Grids of more than `max_bytes` are rejected.
/// Errors  UsageError: this build has no OpenVDB. InputError: no such level, damaged shards, disk full, indices beyond
///         32 bits, or too large. No file is left behind.
std::uint64_t export_openvdb(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& vdb,
                             std::uint64_t max_bytes, const Progress& progress = {});

/// Returns half of this machine's memory.
std::uint64_t openvdb_memory_bytes();

}  // namespace gigabake
