/// Hash of a brick's voxel: its lattice position and its content.
#pragma once

#include <cstdint>

#include "core/octree/brick.h"
#include "core/octree/morton.h"
#include "core/octree/voxel_hash.h"
#include "kernels/body/voxel.h"

namespace gigabake::kernels {

/// Hashes voxel x + 8y + 64z of a brick of level `lod`. `window_min` is CellParameters::window_min.
/// `directional_coverage` points to the voxel's directional coverage; it is null if the level has none.
/// Exact   Integers: host and device return the same bits.
GB_HD Hash128 hash_of_voxel(const std::int64_t window_min[3], int lod, const BrickCoordinate& brick, int voxel,
                            std::uint32_t rgba, std::uint16_t normal, const std::uint8_t* directional_coverage) {
  const std::int64_t x = window_min[0] + (std::int64_t(brick.x * brick_edge + (voxel & 7)) << lod),
                     y = window_min[1] + (std::int64_t(brick.y * brick_edge + (voxel >> 3 & 7)) << lod),
                     z = window_min[2] + (std::int64_t(brick.z * brick_edge + (voxel >> 6)) << lod);
  if (directional_coverage == nullptr) return hash_voxel(lod, x, y, z, rgba, normal);
  return hash_voxel(lod, x, y, z, rgba, normal, pack_directional_coverage(directional_coverage));
}

}  // namespace gigabake::kernels
