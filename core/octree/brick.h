/// Sizes that all modules share: a brick is 8 × 8 × 8 voxels of one level; a voxel is 256 sub-voxels wide.
#pragma once

#include <cstdint>

namespace gigabake {

inline constexpr int brick_edge = 8;
inline constexpr int brick_voxels = 512;
inline constexpr int subvoxel_bits = 8;  ///< positions are rounded once, to 1/256 voxel (snap.h)
inline constexpr std::int64_t subvoxels = 1 << subvoxel_bits;

}  // namespace gigabake
