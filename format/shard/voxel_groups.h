/// A brick's voxels by octants of 4×4×4 and groups of 2×2×2 (shared_values.h).
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "format/shard/shard.h"

namespace gigabake {

inline constexpr std::size_t groups_a_brick = 64;

/// 8·octant + group of voxel (x, y, z), by x + 8y + 64z.
inline constexpr std::array<std::uint8_t, brick_voxels> group_of_voxel = [] {
  std::array<std::uint8_t, brick_voxels> group{};
  for (unsigned v = 0; v < brick_voxels; ++v) {
    const unsigned octant = (v >> 2 & 1) | (v >> 5 & 1) << 1 | (v >> 8 & 1) << 2;
    const unsigned within = (v >> 1 & 1) | (v >> 4 & 1) << 1 | (v >> 7 & 1) << 2;
    group[v] = std::uint8_t(8 * octant + within);
  }
  return group;
}();

/// visit(group) for each voxel of the brick, in order.
template <class Visit>
void for_each_group_of_voxels(const std::uint64_t* mask, const Visit& visit) {
  for (unsigned z = 0; z < brick_edge; ++z)
    for (std::uint64_t rest = mask[z]; rest != 0; rest &= rest - 1)
      visit(group_of_voxel[64 * z + unsigned(std::countr_zero(rest))]);
}

}  // namespace gigabake
