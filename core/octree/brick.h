/// Sizes that all modules share: a brick is 8 × 8 × 8 voxels of one level; a voxel is 256 sub-voxels wide.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"

namespace gigabake {

inline constexpr int brick_edge = 8;
inline constexpr int brick_voxels = 512;
inline constexpr int subvoxel_bits = 8;  ///< positions are rounded once, to 1/256 voxel (snap.h)
inline constexpr std::int64_t subvoxels = 1 << subvoxel_bits;

/// Returns word z of the mask of the voxels of a brick that lie in octants: bit x + 8y. Bit x | y<<1 | z<<2 of
/// `octants` selects an octant of 4 × 4 × 4 voxels.
GB_HD constexpr std::uint64_t octant_word(unsigned octants, unsigned z) {
  const unsigned four = z < 4 ? octants : octants >> 4;
  std::uint64_t word = 0;
  for (unsigned octant = 0; octant < 4; ++octant)
    if ((four >> octant & 1) != 0) word |= std::uint64_t(0x0f0f0f0f) << (4 * (octant & 1) + 32 * (octant >> 1));
  return word;
}

/// Returns the octants of a brick that have voxels, as bits of octant_word().
GB_HD constexpr unsigned occupied_octants(const std::uint64_t mask[brick_edge]) {
  unsigned octants = 0;
  for (unsigned octant = 0; octant < 8; ++octant)
    for (unsigned z = 4 * (octant >> 2); z < 4 * (octant >> 2) + 4; ++z)
      if ((mask[z] & octant_word(1u << octant, z)) != 0) octants |= 1u << octant;
  return octants;
}

}  // namespace gigabake
