/// Voxels of one level as a NanoVDB file.
#pragma once

#include <cstdint>
#include <filesystem>

#include "lattice/progress.h"

namespace gigabake {

/// Two grids of class VoxelVolume: "rgba" (RGBA8: sRGB colour, coverage) and, where the scene has normals, "normal"
/// (Vec3f, unit vectors). Active are the voxels that exist; index (i, j, k) is the lattice index at that lod; the map
/// takes it to the voxel's lowest corner in scene metres. Uncompressed (docs/format.md).
/// Exact   colours are the shards' bytes, normals the nearest floats.
/// Cost    One level of one cell and at most 48 bytes a brick in memory; shards are read twice.
/// Errors  InputError: no such level, damaged shards, disk full, indices beyond 32 bits. Nothing is left behind.
/// Returns the number of voxels.
std::uint64_t export_nanovdb(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& nvdb,
                             const Progress& progress = {});

}  // namespace gigabake
