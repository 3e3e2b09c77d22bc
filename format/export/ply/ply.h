/// Export of one level's voxels to a binary point cloud.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/base/progress.h"

namespace gigabake {

/// Writes a binary_little_endian PLY file with one vertex per voxel. A vertex has the voxel's centre in scene metres
/// (double x y z). Its lattice index (int i j k) is in voxels of 2^lod from the lattice's 0,0,0. Its attributes are
/// uchar red green blue alpha, float nx ny nz (0 if the scene has no normals), and ushort class if the scene has
/// classes.
/// The header of a georeferenced scene has the origin of its frame in comments. Cells are in the scene's order. Levels
/// from 4 up may not be aligned with the lattice; i, j and k are then rounded down. Returns the number of voxels.
/// Cost    Holds one level of one cell in memory.
/// Errors  InputError: the level does not exist, a shard is damaged, the disk is full, or an index exceeds 32 bits. No
///         file is left behind.
std::uint64_t export_ply(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& ply,
                         const Progress& progress = {});

}  // namespace gigabake
