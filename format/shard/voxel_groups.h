/// A brick's voxels by octants of 4×4×4 and groups of 2×2×2 (lattice/pack/shared_value.h), for the host's loops.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "format/shard/shard.h"
#include "lattice/pack/shared_value.h"

namespace gigabake {

/// group_of() of every voxel of a brick: a table is faster than its shifts.
inline constexpr std::array<std::uint8_t, brick_voxels> group_of_voxel = [] {
  std::array<std::uint8_t, brick_voxels> group{};
  for (unsigned v = 0; v < brick_voxels; ++v) group[v] = std::uint8_t(group_of(v));
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
