/// What a voxel gathers from the triangles that touch it: integer sums, so that their order does not matter.
#pragma once

#include <cstdint>

#include "kernels/types.h"

namespace gigabake::kernels {

/// One triangle's contribution to one voxel.
struct Fragment {
  std::int64_t weight;     ///< area, 2^-36 voxel², ≥ 1
  std::uint16_t rgba[4];   ///< linear, premultiplied; alpha 65535 = opaque
  std::int16_t normal[3];  ///< unit length 32767
};

/// Channels of an accumulator.
enum Sum : int { sum_weight, sum_alpha, sum_red, sum_green, sum_blue, sum_nx, sum_ny, sum_nz, sum_count };

/// Fragments that a 64-bit accumulator surely takes: each adds at most √3·2^36·65535 < 2^53.
inline constexpr int fragments_before_flush = 1024;

/// Calls add(channel, value) for each sum of a fragment, wherever the sums are kept.
template <class Add>
GB_HD void contribute(const Fragment& f, const Add& add) {
  const std::int64_t w = f.weight;
  // Invisible parts have no say in the normal: scale its weight by alpha.
  const std::int64_t visible = f.rgba[3] == 65535 ? w : (w * f.rgba[3]) / 65535;
  add(sum_weight, w);
  add(sum_alpha, w * f.rgba[3]);
  add(sum_red, w * f.rgba[0]);
  add(sum_green, w * f.rgba[1]);
  add(sum_blue, w * f.rgba[2]);
  add(sum_nx, visible * f.normal[0]);
  add(sum_ny, visible * f.normal[1]);
  add(sum_nz, visible * f.normal[2]);
}

template <class I>
GB_HD void accumulate(I sums[sum_count], const Fragment& f) {
  contribute(f, [sums](Sum channel, std::int64_t value) { sums[channel] += value; });
}

}  // namespace gigabake::kernels
