/// Export of one level's voxels to a point cloud in LAS 1.4, uncompressed.
///
/// Source  ASPRS LAS Specification 1.4 - R15: point data record format 7, coordinate system as WKT, extra bytes.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "core/base/progress.h"

namespace gigabake {

/// The coordinates of the points. A file stores X, Y and Z as 32-bit integers: a coordinate is X · scale + offset.
struct LasFrame {
  std::string wkt;  ///< the coordinate system
  /// Converts points from scene metres in place; null for the scene's own frame, whose scale and offset are exact.
  std::function<void(std::span<std::array<double, 3>>)> from_scene_m;
  std::array<double, 3> scale{}, offset{};  ///< only used with from_scene_m
};

/// Writes one point per voxel, at the voxel's centre, in the order of export_ply(). A point has the voxel's colour (16
/// bits: the byte times 257). Extra bytes are `coverage` (0 to 255) and the normal along the scene's axes (`NormalX`,
/// `NormalY`, `NormalZ`), which is absent if the scene has no normals. If the scene has classes, the classification of
/// LAS is the class, or 0 above 255, and the extra bytes `VoxelClass` have it exactly; else it is 0 (never classified).
/// Returns the number of voxels.
/// Exact   In the scene's frame, scale is half a voxel of lod 0 and offset the lattice's origin: coordinates are the
///         doubles of export_ply(). In another frame, coordinates are rounded to the nearest multiple of scale.
/// Cost    Holds one level of one cell in memory.
/// Errors  InputError: the level does not exist, a shard is damaged, the disk is full, a point has no coordinates in
///         the system, or its integers exceed 32 bits. No file is left behind.
std::uint64_t export_las(const std::filesystem::path& scene_xml, int lod, const std::filesystem::path& las,
                         const LasFrame& frame, const Progress& progress = {});

}  // namespace gigabake
