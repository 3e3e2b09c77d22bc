/// The rules of shared values: which voxels of a brick share a value, the order of values, and which channels share
/// values. The packers of host and device both use these functions.
///
/// A brick has 8 octants of 4×4×4 voxels; an octant has 8 groups of 2×2×2. Octants and groups are numbered x + 2y + 4z
/// in their parent. A brick, octant or group with equal voxels has one value, at the place of its first voxel. See
/// docs/format.md, "Shared values".
///
/// Exact   Integers: host and device return the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/octree/brick.h"

namespace gigabake {

/// The bytes of a brick's `share`. Bit g of byte o, 0 to 7, is set if group g of octant o has one value. Bit o of byte
/// 8 is set if octant o has one value. Byte 9 is 1 if the whole brick has one value, else 0.
inline constexpr std::size_t share_bytes = 10;
inline constexpr unsigned groups_per_brick = 64, octants_a_brick = 8;
inline constexpr std::size_t max_value_bytes = 4;  ///< max size of a voxel's value, bytes

/// Returns 8·octant + group of voxel (x, y, z), numbered x + 8y + 64z.
GB_HD constexpr unsigned group_of(unsigned voxel) {
  const unsigned octant = (voxel >> 2 & 1) | (voxel >> 5 & 1) << 1 | (voxel >> 8 & 1) << 2;
  const unsigned within = (voxel >> 1 & 1) | (voxel >> 4 & 1) << 1 | (voxel >> 7 & 1) << 2;
  return octants_a_brick * octant + within;
}

/// Returns the bit mask of an octant's groups; bit i is the group with group_of() = i.
GB_HD constexpr std::uint64_t octant_groups(unsigned octant) { return std::uint64_t(0xff) << 8 * octant; }

/// Loads a value byte by byte. A copy of three bytes to a word in memory would make the load of that word wait for the
/// store.
/// Range   width ≤ max_value_bytes.
template <class Width>
GB_HD std::uint32_t value_at(const std::uint8_t* bytes, Width width) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < width; ++i) value |= std::uint32_t(bytes[i]) << 8 * i;
  return value;
}

GB_HD unsigned lowest_bit(std::uint64_t bits) {
#if defined(__CUDA_ARCH__)
  return unsigned(__ffsll((long long)(bits)) - 1);
#else
  return unsigned(__builtin_ctzll(bits));
#endif
}

GB_HD unsigned bits_in(std::uint64_t bits) {
#if defined(__CUDA_ARCH__)
  return unsigned(__popcll(bits));
#else
  return unsigned(__builtin_popcountll(bits));
#endif
}

/// The values of one channel of a brick, by group. `first` is borrowed.
struct GroupValues {
  const std::uint32_t* first;  ///< the value of the first voxel of each non-empty group
  std::uint64_t seen;          ///< non-empty groups
  std::uint64_t mixed;         ///< groups with different voxel values
};

/// Returns true if all voxels of the groups in `which` are equal.
/// Range   `which` has at least one group, and none of its groups is empty.
GB_HD bool are_alike(const GroupValues& values, std::uint64_t which) {
  if ((values.mixed & which) != 0) return false;
  const std::uint32_t first = values.first[lowest_bit(which)];
  for (std::uint64_t rest = which & (which - 1); rest != 0; rest &= rest - 1)
    if (values.first[lowest_bit(rest)] != first) return false;
  return true;
}

/// Writes `share` (share_bytes long), which records the voxels of the brick that share a value. `mixed_voxels` is the
/// number of voxels in mixed groups; each of these voxels stores a separate value. Returns the number of values of the
/// brick.
GB_HD std::uint32_t share_brick(const GroupValues& values, std::uint32_t mixed_voxels, std::uint8_t* share) {
  std::uint32_t count = mixed_voxels;
  std::uint8_t octants = 0;
  for (unsigned o = 0; o < octants_a_brick; ++o) {
    const std::uint64_t octant = values.seen & octant_groups(o), alike = octant & ~values.mixed;
    share[o] = std::uint8_t(alike >> 8 * o);
    if (octant == 0) continue;
    const bool is_one = are_alike(values, octant);
    octants = std::uint8_t(octants | unsigned(is_one) << o);
    count += is_one ? 1 : bits_in(alike);
  }
  share[8] = octants;
  const bool is_one_brick = values.seen == 0 || are_alike(values, values.seen);
  share[9] = is_one_brick ? 1 : 0;
  return values.seen == 0 ? 0 : is_one_brick ? 1 : count;
}

/// A decoder of a brick's `share`. It maps each group to its leader: the group whose value it uses.
class ValueLeaders {
 public:
  GB_HD explicit ValueLeaders(const std::uint8_t* share) : is_one_(share[9] != 0) {
    for (unsigned o = 0; o < octants_a_brick; ++o) {
      if ((share[8] >> o & 1) != 0) by_octant_ |= octant_groups(o);
      sharing_ |= std::uint64_t(share[o]) << 8 * o;
    }
    sharing_ = is_one_ ? ~std::uint64_t(0) : sharing_ | by_octant_;
  }

  /// Returns true if all voxels of the group have one value, possibly shared with other groups.
  GB_HD bool are_one(unsigned group) const { return (sharing_ >> group & 1) != 0; }
  /// Returns the number of the group's leader. Groups that share a value have the same leader.
  GB_HD unsigned leader(unsigned group) const {
    return is_one_ ? 0 : (by_octant_ >> group & 1) != 0 ? group & ~7u : group;
  }
  /// Returns true if a voxel stores a value: its group is mixed, or no earlier voxel has the same leader. Bit i of
  /// `led` is set if an earlier voxel has the leader i.
  GB_HD bool is_new(unsigned group, std::uint64_t led) const {
    return (~(sharing_ >> group & led >> leader(group)) & 1) != 0;
  }

 private:
  std::uint64_t by_octant_ = 0, sharing_ = 0;
  bool is_one_;
};

enum class ValuesStored : std::uint8_t {
  plain,   ///< one value per voxel
  one,     ///< one value for all voxels
  shared,  ///< the values of bricks, octants and groups, with NAME_share and NAME_first
};

/// Returns how a level stores a channel. It stores one value if all voxels are equal, and shared values if these save
/// more than a quarter of the bytes. `values` is the sum of share_brick() over all bricks. The columns share and first
/// take about 12 packed bytes per brick.
GB_HD ValuesStored how_stored(std::uint64_t voxels, bool all_alike, std::uint64_t values, std::uint64_t bricks,
                              std::size_t width) {
  if (voxels > 1 && all_alike) return ValuesStored::one;
  return 4 * (values * width + (share_bytes + 2) * bricks) < 3 * voxels * width ? ValuesStored::shared
                                                                                : ValuesStored::plain;
}

/// Returns the number of values stored. `shared` is the sum of share_brick() over all bricks.
GB_HD std::uint64_t values_stored(ValuesStored how, std::uint64_t voxels, std::uint64_t shared) {
  return how == ValuesStored::one ? 1 : how == ValuesStored::shared ? shared : voxels;
}

}  // namespace gigabake
