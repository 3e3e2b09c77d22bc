/// Which value voxels may share that need not be exact: the largest of brick, octant and group whose voxels all have a
/// common value within the bound takes that value. A brick has 8 octants of 4×4×4 voxels, an octant 8 groups of 2×2×2.
/// Exact  Integers: host and device return the same bits, in whatever order voxels are added and ranges joined.
#pragma once

#include <cstdint>

#include "kernels/body/tables.h"
#include "kernels/body/voxel.h"
#include "lattice/octahedral.h"
#include "lattice/pack/shared_value.h"

namespace gigabake::kernels {

/// Brick, octants and groups in one list: 0, 1 + octant, 9 + 8·octant + group; the last two numbered x + 2y + 4z in
/// their parent.
inline constexpr int shares = 1 + 8 + 64;

/// The group of voxel x + 8y + 64z. Its octant is 1 + (share − 9) / 8.
GB_HD int group_share(int voxel) { return 1 + int(octants_a_brick + group_of(unsigned(voxel))); }
GB_HD int octant_share(int group) { return 1 + (group - 9) / 8; }

/// The lowest voxel, as x + 8y + 64z, of the group that group_of() numbers so; the others are 1, 8, 64 and their sums
/// further.
GB_HD unsigned lowest_voxel_of(unsigned group) {
  const unsigned octant = group / octants_a_brick;
  unsigned voxel = 0;
  for (unsigned axis = 0; axis < 3; ++axis) voxel += (4 * (octant >> axis & 1) + 2 * (group >> axis & 1)) << 3 * axis;
  return voxel;
}

/// Of one 8-bit channel over a share's voxels.
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
  /// The mean, or what is nearest to it within `codes` of both ends. Range  fits(codes), count voxels were added.
  GB_HD std::uint8_t value(std::uint32_t count, std::uint32_t codes) const {
    const std::uint32_t mean = (2 * sum + count) / (2 * count);
    if (mean + codes < high) return std::uint8_t(high - codes);
    return std::uint8_t(mean > low + codes ? low + codes : mean);
  }
};

/// Of a share's normals.
struct NormalRange {
  std::int16_t low[3] = {32767, 32767, 32767}, high[3] = {-32767, -32767, -32767};
  std::uint16_t value = 0;  ///< the common one, encoded
  bool fits = true;

  GB_HD void add(const std::int16_t* unit) {
    for (int a = 0; a < 3; ++a) {
      low[a] = unit[a] < low[a] ? unit[a] : low[a];
      high[a] = unit[a] > high[a] ? unit[a] : high[a];
    }
  }
  GB_HD void join(const NormalRange& of) {
    for (int a = 0; a < 3; ++a) {
      low[a] = of.low[a] < low[a] ? of.low[a] : low[a];
      high[a] = of.high[a] > high[a] ? of.high[a] : high[a];
    }
  }
  /// The direction of the box's middle.
  GB_HD void choose() {
    std::int8_t oct[2];
    encode_octahedral(low[0] + high[0], low[1] + high[1], low[2] + high[2], oct);
    value = pack_normal(oct);
  }
};

/// |a − b| ≤ 2·codes/255 of unit vectors.
GB_HD bool within_chord(const std::int16_t* a, const std::int16_t* b, std::uint32_t codes) {
  std::int64_t squared = 0;
  for (int c = 0; c < 3; ++c) squared += std::int64_t(a[c] - b[c]) * (a[c] - b[c]);
  const std::int64_t bound = std::int64_t(2) * codes * 32767;
  return squared * (255 * 255) <= bound * bound;
}

}  // namespace gigabake::kernels
