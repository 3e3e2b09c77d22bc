/// Variable depth: voxels that differ by no more than they may become alike, so that a shard stores them once.
///
/// A brick has 8 octants of 4×4×4 voxels, an octant 8 groups of 2×2×2. Colour, alpha, facing and normal go each by
/// itself: the largest of brick, octant and group whose voxels all have a common value within the bound takes that
/// value.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/body/cell.h"
#include "kernels/body/tables.h"
#include "kernels/body/voxel.h"
#include "lattice/octahedral.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// Changes the levels' voxels, not which there are.
/// Exact   No voxel's red, green, blue, alpha or facing changes by more than `codes` of 255, and no normal by a
///         chord of more than 2·codes/255, unit vectors as Tables::unit_normal has them. Depends on the brick alone.
/// Range   codes ≤ 127. 0: nothing changes.
void approximate(std::vector<Level>& levels, std::uint32_t codes, const ThreadPool& pool);

/// Brick, octants and groups in one list: 0, 1 + octant, 9 + 8·octant + group; the last two numbered x + 2y + 4z in
/// their parent.
inline constexpr int shares = 1 + 8 + 64;

/// The group of voxel x + 8y + 64z. Its octant is 1 + (share − 9) / 8.
GB_HD int group_share(int voxel) {
  const int octant = (voxel >> 2 & 1) | (voxel >> 5 & 1) << 1 | (voxel >> 8 & 1) << 2;
  const int group = (voxel >> 1 & 1) | (voxel >> 4 & 1) << 1 | (voxel >> 7 & 1) << 2;
  return 9 + 8 * octant + group;
}
GB_HD int octant_share(int group) { return 1 + (group - 9) / 8; }

/// Of one 8-bit channel over a share's voxels.
struct CodeRange {
  std::uint32_t low = 255, high = 0, sum = 0;

  GB_HD void add(std::uint8_t code) {
    low = code < low ? code : low;
    high = code > high ? code : high;
    sum += code;
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
