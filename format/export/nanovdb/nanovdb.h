/// Export of one level's voxels to a NanoVDB file.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/base/progress.h"

namespace gigabake {

/// Writes two grids of class VoxelVolume: "rgba" (RGBA8: sRGB colour, coverage) and, if the scene has normals, "normal"
/// (Vec3f, unit vectors). Existing voxels are active. Returns their number.
/// Space   Index (i, j, k) is the lattice index at that lod; the map yields the voxel's lowest corner in scene metres.
///         Uncompressed (docs/format.md).
/// Exact   Colours are the shards' bytes, normals the nearest floats.
/// Cost    One level of one cell and at most 48 bytes per brick in memory; reads shards twice.
/// Errors  InputError: no such level, damaged shards, disk full, or indices beyond 32 bits. No file is left behind.
std::uint64_t export_nanovdb(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& nvdb,
                             const Progress& progress = {});

}  // namespace gigabake
