#include "format/shard/columns/shared_values.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "format/shard/columns/voxel_groups.h"

namespace gigabake {
namespace {

std::size_t count_voxels(const std::uint64_t* mask) {
  int bits = 0;
  for (std::size_t z = 0; z < brick_edge; ++z) bits += std::popcount(mask[z]);
  return std::size_t(bits);
}

/// Calls visit(voxel, value) for each voxel of the brick, with the indices of the voxel and its value in the brick.
/// Returns the number of values.
template <class Visit>
std::size_t for_each_value(const std::uint64_t* mask, const std::uint8_t* share, const Visit& visit) {
  const ValueLeaders leaders(share);
  std::array<std::uint16_t, groups_per_brick> value_of;
  std::uint64_t led = 0;
  std::size_t voxel = 0, values = 0;
  for_each_group_of_voxels(mask, [&](std::uint8_t group) {
    const unsigned leader = leaders.leader(group);
    const bool is_new = leaders.is_new(group, led);
    if (is_new) value_of[leader] = std::uint16_t(values++);
    led |= std::uint64_t(1) << leader;
    visit(voxel++, std::size_t(value_of[leader]));
  });
  return values;
}

}  // namespace

bool spread_values(const std::uint64_t* mask, const std::uint8_t* share, std::span<const std::uint8_t> value,
                   std::size_t width, ChannelBytes<std::uint8_t> to) {
  const std::size_t values = value.size() / width;
  if (values == 0) return false;
  std::size_t count = 0;
  with_known_width(width, [&](auto known) {
    if (share[9] != 0) {  // most bricks of the alpha channel of opaque surfaces
      const std::size_t voxels = count_voxels(mask);
      for (std::size_t v = 0; v < voxels; ++v) std::memcpy(to[v], value.data(), known);
      count = 1;
      return;
    }
    count = for_each_value(mask, share, [&](std::size_t voxel, std::size_t number) {
      std::memcpy(to[voxel], &value[std::min(number, values - 1) * known], known);
    });
  });
  return count == values;
}

}  // namespace gigabake
