/// Integer sums of a voxel over its triangles. Integers make the result independent of the order of the triangles.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/vec3.h"

namespace gigabake::kernels {

/// One triangle's contribution to one voxel.
struct Fragment {
  std::int64_t weight;        ///< area, 2^-36 voxel², ≥ 1
  std::uint16_t alpha;        ///< 65535 = opaque: the voxel is then opaque, whatever else it contains
  std::int64_t colour[3];     ///< weight · linear, premultiplied colour, 0 … 65535 · weight
  Vec3<std::int16_t> normal;  ///< unit length 32767
};

/// Returns a fragment of one colour. `rgba` is linear and premultiplied; 65535 = 1.
GB_HD Fragment fragment_of_colour(std::int64_t weight, const std::uint16_t rgba[4], const Vec3<std::int16_t>& normal) {
  return {weight, rgba[3], {weight * rgba[0], weight * rgba[1], weight * rgba[2]}, normal};
}

/// Channels of an accumulator. The last two are not needed if all fragments are opaque. `sum_clear` is the sum of
/// weight · (65535 − alpha). `sum_opaque` is 0 if and only if no fragment is opaque.
enum Sum : int { sum_weight, sum_red, sum_green, sum_blue, sum_nx, sum_ny, sum_nz, sum_clear, sum_opaque, sum_count };
inline constexpr int opaque_sum_count = sum_clear;

/// Number of fragments that a 64-bit accumulator holds without overflow: each adds at most √3·2^36·65535 < 2^53.
inline constexpr int fragments_before_flush = 1024;

/// Calls add(channel, value) for each sum of a fragment. The caller decides where the sums are stored.
template <class Add>
GB_HD void contribute(const Fragment& f, const Add& add) {
  // Transparent parts must not influence the normal, so the normal's weight is scaled by alpha.
  const std::int64_t clear = f.weight * (65535 - f.alpha);
  const std::int64_t visible = clear == 0 ? f.weight : (f.weight * 65535 - clear) / 65535;
  add(sum_weight, f.weight);
  for (int c = 0; c < 3; ++c) add(Sum(sum_red + c), f.colour[c]);
  for (int c = 0; c < 3; ++c) add(Sum(sum_nx + c), visible * f.normal[c]);
  clear == 0 ? add(sum_opaque, 1) : add(sum_clear, clear);
}

template <class I>
GB_HD void accumulate(I sums[sum_count], const Fragment& f) {
  contribute(f, [sums](Sum channel, std::int64_t value) { sums[channel] += value; });
}

}  // namespace gigabake::kernels
