/// Hash of a brick's voxel: its lattice position and its content.
#pragma once

#include <cstdint>

#include "core/math/vec3.h"
#include "core/octree/brick.h"
#include "core/octree/morton.h"
#include "core/octree/voxel_hash.h"
#include "kernels/body/voxel.h"

namespace gigabake::kernels {

/// Returns the lowest corner of voxel x + 8y + 64z of a brick of level `lod`, in lod-0 voxels of the lattice.
GB_HD Vec3i64 corner_of_voxel(const Vec3i64& window_min, int lod, const BrickCoordinate& brick, int voxel) {
  const auto in_brick = Vec3<std::uint32_t>::by_axis([&](int axis) { return std::uint32_t(voxel) >> 3 * axis & 7; });
  const Vec3<std::uint32_t> in_window = static_cast<Vec3<std::uint32_t>>(brick) * brick_edge + in_brick;
  return window_min + (static_cast<Vec3i64>(in_window) << lod);
}

/// Hashes voxel x + 8y + 64z of a brick of level `lod`. `window_min` is CellParameters::window_min.
/// `directional_coverage` points to the voxel's directional coverage; it is null if the level has none.
/// Exact   Integers: host and device return the same bits.
GB_HD Hash128 hash_of_voxel(const Vec3i64& window_min, int lod, const BrickCoordinate& brick, int voxel,
                            std::uint32_t rgba, std::uint16_t normal, const std::uint8_t* directional_coverage) {
  const Vec3i64 at = corner_of_voxel(window_min, lod, brick, voxel);
  if (directional_coverage == nullptr) return hash_voxel(lod, at[0], at[1], at[2], rgba, normal);
  return hash_voxel(lod, at[0], at[1], at[2], rgba, normal, pack_directional_coverage(directional_coverage));
}

/// Hashes a voxel of a level with classes.
GB_HD Hash128 hash_of_voxel(const Vec3i64& window_min, int lod, const BrickCoordinate& brick, int voxel,
                            std::uint32_t rgba, std::uint16_t normal, const std::uint8_t* directional_coverage,
                            VoxelClass voxel_class) {
  const Vec3i64 at = corner_of_voxel(window_min, lod, brick, voxel);
  return hash_voxel(lod, at[0], at[1], at[2], rgba, normal,
                    directional_coverage == nullptr ? 0 : pack_directional_coverage(directional_coverage), voxel_class);
}

}  // namespace gigabake::kernels
