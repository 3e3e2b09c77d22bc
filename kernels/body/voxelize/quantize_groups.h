/// Lossy sharing of values between voxels. Sharing units are a brick, its 8 octants of 4×4×4 voxels, and the 8 groups
/// of 2×2×2 voxels in each octant. A voxel takes the common value of the largest unit that contains it and whose voxels
/// all lie within the error bound of that value.
/// Exact   Integers: host and device return the same bits, in any order of adding voxels and joining ranges.
#pragma once

#include <cstdint>

#include "core/codec/shared_value.h"
#include "core/math/octahedral.h"
#include "core/math/vec3.h"
#include "kernels/body/tables.h"
#include "kernels/body/voxel.h"

namespace gigabake::kernels {

/// Number of sharing units: the brick has index 0, an octant 1 + octant, a group 9 + 8·octant + group. Octants and
/// groups are numbered x + 2y + 4z in their parent.
inline constexpr int shares = 1 + 8 + 64;

/// Returns the index of the sharing unit of the group that contains voxel x + 8y + 64z.
GB_HD int group_share(int voxel) { return 1 + int(octants_a_brick + group_of(unsigned(voxel))); }
/// Returns the index of the sharing unit of the octant that contains the group with index `group`.
GB_HD int octant_share(int group) { return 1 + (group - 9) / 8; }

/// Returns the lowest voxel, as x + 8y + 64z, of a group numbered by group_of(). The group's other voxels follow at
/// offsets 1, 8, 64 and their sums.
GB_HD unsigned lowest_voxel_of(unsigned group) {
  const unsigned octant = group / octants_a_brick;
  unsigned voxel = 0;
  for (unsigned axis = 0; axis < 3; ++axis) voxel += (4 * (octant >> axis & 1) + 2 * (group >> axis & 1)) << 3 * axis;
  return voxel;
}

/// Range of one 8-bit channel over the voxels of a sharing unit.
struct CodeRange {
  std::uint32_t low = 255, high = 0, sum = 0;

  GB_HD void add(std::uint8_t code) {
    low = code < low ? code : low;
    high = code > high ? code : high;
    sum += code;
  }
  GB_HD void join(const CodeRange& of) {
    low = of.low < low ? of.low : low;
    high = of.high > high ? of.high : high;
    sum += of.sum;
  }
  GB_HD bool fits(std::uint32_t codes) const { return high <= low + 2 * codes; }
  /// Returns the code nearest to the mean that differs from `low` and from `high` by at most `codes` steps.
  /// Range   fits(codes); `count` voxels were added.
  GB_HD std::uint8_t value(std::uint32_t count, std::uint32_t codes) const {
    const std::uint32_t mean = (2 * sum + count) / (2 * count);
    if (mean + codes < high) return std::uint8_t(high - codes);
    return std::uint8_t(mean > low + codes ? low + codes : mean);
  }
};

/// Range of the normals of a sharing unit.
struct NormalRange {
  Vec3<std::int16_t> low = Vec3<std::int16_t>::all(32767), high = Vec3<std::int16_t>::all(-32767);
  std::uint16_t value = 0;  ///< the common normal, packed by pack_normal()
  bool fits = true;

  GB_HD void add(const Vec3<std::int16_t>& unit) {
    for (int a = 0; a < 3; ++a) {  // Assigning whole vectors would cost a device 16 more registers.
      low[a] = unit[a] < low[a] ? unit[a] : low[a];
      high[a] = unit[a] > high[a] ? unit[a] : high[a];
    }
  }
  GB_HD void join(const NormalRange& of) {
    low = min_by_axis(low, of.low);
    high = max_by_axis(high, of.high);
  }
  /// Sets `value` to the direction of the centre of the range's box.
  GB_HD void choose() {
    std::int8_t oct[2];
    encode_octahedral(low[0] + high[0], low[1] + high[1], low[2] + high[2], oct);
    value = pack_normal(oct);
  }
};

/// Returns true if the unit vectors satisfy |a − b| ≤ 2·codes/255.
GB_HD bool within_chord(const Vec3<std::int16_t>& a, const Vec3<std::int16_t>& b, std::uint32_t codes) {
  const auto apart = static_cast<Vec3i64>(static_cast<Vec3<std::int32_t>>(a) - static_cast<Vec3<std::int32_t>>(b));
  const std::int64_t bound = std::int64_t(2) * codes * 32767;
  return dot(apart, apart) * (255 * 255) <= bound * bound;
}

}  // namespace gigabake::kernels
