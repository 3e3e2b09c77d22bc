/// Octants and groups of a brick's voxels, and the rules of values that voxels share in shards of versions 2 to 6.
///
/// A brick has 8 octants of 4×4×4 voxels; an octant has 8 groups of 2×2×2. Octants and groups are numbered x + 2y + 4z
/// in their parent. A brick, octant or group with equal voxels has one value, at the place of its first voxel. See
/// docs/format-shards-1-to-6.md.
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

/// Returns 8·octant + group of voxel (x, y, z), numbered x + 8y + 64z.
GB_HD constexpr unsigned group_of(unsigned voxel) {
  const unsigned octant = (voxel >> 2 & 1) | (voxel >> 5 & 1) << 1 | (voxel >> 8 & 1) << 2;
  const unsigned within = (voxel >> 1 & 1) | (voxel >> 4 & 1) << 1 | (voxel >> 7 & 1) << 2;
  return octants_a_brick * octant + within;
}

/// Returns the bit mask of an octant's groups; bit i is the group with group_of() = i.
GB_HD constexpr std::uint64_t octant_groups(unsigned octant) { return std::uint64_t(0xff) << 8 * octant; }

GB_HD unsigned bits_in(std::uint64_t bits) {
#if defined(__CUDA_ARCH__)
  return unsigned(__popcll(bits));
#else
  return unsigned(__builtin_popcountll(bits));
#endif
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

}  // namespace gigabake
