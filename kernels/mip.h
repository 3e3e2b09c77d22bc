/// One voxel of a coarser level from the 2×2×2 voxels below it.
///
/// Exact   Integers (colour, coverage) and IEEE double (octahedral encode): host and device return the same bits.
#pragma once

#include <cstdint>

#include "kernels/octahedral.h"
#include "kernels/resolve.h"
#include "kernels/tables.h"
#include "kernels/types.h"

namespace gigabake::kernels {

/// Child c = x | y<<1 | z<<2; present bit c says whether it exists. An absent child has alpha 0.
struct VoxelOctet {
  Voxel child[8];
  std::uint8_t present;
};

/// 255²·coverage of two voxels one behind the other.
GB_HD std::uint32_t behind_each_other(std::uint32_t a, std::uint32_t b) { return 255 * (a + b) - a * b; }

/// Mean over the three axes of the coverage that a view along the axis sees: four columns of two voxels an axis.
GB_HD std::uint32_t directional_coverage(const std::uint32_t alpha[8]) {
  std::uint32_t sum = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int c = 0; c < 8; ++c)
      if ((c >> axis & 1) == 0) sum += behind_each_other(alpha[c], alpha[c | 1 << axis]);
  return (sum + 1530) / 3060;  // 12 columns · 255, rounded
}

GB_HD std::uint32_t filtered_coverage(const std::uint32_t alpha[8], MipFilter filter, const Tables& tables) {
  if (filter == MipFilter::coverage) return directional_coverage(alpha);
  std::uint32_t sum = 0;
  for (int c = 0; c < 8; ++c) sum += alpha[c];
  return filter == MipFilter::thesis ? tables.thesis_alpha[sum] : (sum + 4) / 8;
}

/// Children as they come, each at most once.
struct MipSums {
  std::uint32_t alpha[8] = {}, alpha_sum = 0, colour[3] = {};
  std::int32_t normal[3] = {};

  GB_HD void add(int c, const Voxel& v, const Tables& tables) {
    alpha[c] = v.rgba[3];
    alpha_sum += alpha[c];
    for (int k = 0; k < 3; ++k) colour[k] += alpha[c] * tables.linear_from_srgb[v.rgba[k]];
    const std::int16_t* n = tables.unit_normal + 4 * (std::uint8_t(v.normal[0]) | std::uint8_t(v.normal[1]) << 8);
    for (int k = 0; k < 3; ++k) normal[k] += std::int32_t(alpha[c]) * n[k];
  }

  /// At least one child was added. The result's alpha is at least 1: what exists does not vanish from a coarser level.
  GB_HD Voxel voxel(MipFilter filter, const Tables& tables) const {
    Voxel out;
    for (int k = 0; k < 3; ++k) out.rgba[k] = tables.srgb_from_linear[(colour[k] + alpha_sum / 2) / alpha_sum];
    const std::uint32_t coverage = filtered_coverage(alpha, filter, tables);
    out.rgba[3] = std::uint8_t(coverage < 1 ? 1 : coverage);
    encode_octahedral(normal[0], normal[1], normal[2], out.normal);
    return out;
  }
};

/// present ≠ 0.
GB_HD Voxel mip(const VoxelOctet& octet, MipFilter filter, const Tables& tables) {
  MipSums sums;
  for (int c = 0; c < 8; ++c)
    if (octet.present >> c & 1) sums.add(c, octet.child[c], tables);
  return sums.voxel(filter, tables);
}

}  // namespace gigabake::kernels
