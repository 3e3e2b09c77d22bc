/// One voxel of a coarser level from the 2×2×2 voxels below it.
///
/// Exact   Integers (colour, coverage) and IEEE double (octahedral encode): host and device return the same bits.
#pragma once

#include <cstdint>

#include "kernels/body/facing.h"
#include "kernels/body/resolve.h"
#include "kernels/body/tables.h"
#include "lattice/host_device.h"
#include "lattice/octahedral.h"
#include "lattice/rules.h"

namespace gigabake::kernels {

/// A voxel of a coarser level.
struct CoarseVoxel {
  Voxel voxel;             ///< its alpha is the largest of `facing`, with MipFilter::coverage
  std::uint8_t facing[3];  ///< coverage that a view along x, y, z sees; set by MipFilter::coverage
};

/// What a level's filter keeps of children, other than coverage, each weighted by what it has to say.
struct MipSums {
  std::uint32_t weight = 0, colour[3] = {};
  std::int32_t normal[3] = {};

  /// w: 0 … 255.
  GB_HD void add(const Voxel& v, std::uint32_t w, const Tables& tables) {
    weight += w;
    for (int k = 0; k < 3; ++k) colour[k] += w * tables.linear_from_srgb[v.rgba[k]];
    const std::int16_t* n = tables.unit_normal + 4 * (std::uint8_t(v.normal[0]) | std::uint8_t(v.normal[1]) << 8);
#if defined(__CUDA_ARCH__)
    const short4 all = *reinterpret_cast<const short4*>(n);  // one load
    normal[0] += std::int32_t(w) * all.x;
    normal[1] += std::int32_t(w) * all.y;
    normal[2] += std::int32_t(w) * all.z;
#else
    for (int k = 0; k < 3; ++k) normal[k] += std::int32_t(w) * n[k];
#endif
  }

  /// Range  weight ≠ 0. The result's alpha is at least 1: what exists does not vanish from a coarser level.
  GB_HD Voxel voxel(std::uint32_t alpha, const Tables& tables) const {
    Voxel out;
    for (int k = 0; k < 3; ++k) out.rgba[k] = tables.srgb_from_linear[(colour[k] + weight / 2) / weight];
    out.rgba[3] = std::uint8_t(alpha < 1 ? 1 : alpha);
    encode_octahedral(normal[0], normal[1], normal[2], out.normal);
    return out;
  }
};

/// Coverage by the filters that have no directions; alpha_sum: of the children, absent ones are 0.
GB_HD std::uint32_t mean_coverage(std::uint32_t alpha_sum, MipFilter filter, const Tables& tables) {
  return filter == MipFilter::thesis ? tables.thesis_alpha[alpha_sum] : (alpha_sum + 4) / 8;
}

GB_HD std::uint32_t largest(const std::uint8_t facing[3]) {
  const std::uint8_t xy = facing[0] > facing[1] ? facing[0] : facing[1];
  return xy > facing[2] ? xy : facing[2];
}

}  // namespace gigabake::kernels
