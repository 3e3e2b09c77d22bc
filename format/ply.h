/// Voxels of one level as a binary point cloud.
#pragma once

#include <cstdint>
#include <filesystem>

namespace gigabake {

/// binary_little_endian PLY; per vertex: double x y z (voxel centre, scene metres), int i j k (lattice index of that
/// lod), uchar red green blue alpha, float nx ny nz. Cells in the scene's order, voxels in Morton order of their
/// bricks. Cost  One cell's level in memory. Returns the number of voxels. Errors  InputError; indices beyond 32 bits
/// are an error, not a wrap.
std::uint64_t export_ply(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& ply);

}  // namespace gigabake
