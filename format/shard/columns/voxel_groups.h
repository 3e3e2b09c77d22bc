/// The octants of 4×4×4 and groups of 2×2×2 voxels in a brick (core/codec/shared_value.h), for loops on the host.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "core/codec/shared_value.h"
#include "format/shard/shard.h"

namespace gigabake {

/// Table of group_of() for every voxel of a brick; faster than the shifts of group_of().
inline constexpr std::array<std::uint8_t, brick_voxels> group_of_voxel = [] {
  std::array<std::uint8_t, brick_voxels> group{};
  for (unsigned v = 0; v < brick_voxels; ++v) group[v] = std::uint8_t(group_of(v));
  return group;
}();

/// Calls visit(group) with the group of each voxel of the brick, in the order of the voxels.
template <class Visit>
void for_each_group_of_voxels(const std::uint64_t* mask, const Visit& visit) {
  for (unsigned z = 0; z < brick_edge; ++z)
    for (std::uint64_t rest = mask[z]; rest != 0; rest &= rest - 1)
      visit(group_of_voxel[64 * z + unsigned(std::countr_zero(rest))]);
}

}  // namespace gigabake
