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
  std::int16_t offset;  ///< distance from the voxel's centre to the triangle's plane, along the triangle's normal;
                        ///< 1/128 voxel, -127 … 127
};

/// Returns a fragment of one colour. `rgba` is linear and premultiplied; 65535 = 1.
GB_HD Fragment fragment_of_colour(std::int64_t weight, const std::uint16_t rgba[4], const Vec3<std::int16_t>& normal,
                                  std::int16_t offset) {
  return {weight, rgba[3], {weight * rgba[0], weight * rgba[1], weight * rgba[2]}, normal, offset};
}

/// Channels of an accumulator. The last two are not needed if all fragments are opaque. `sum_clear` is the sum of
/// weight · (65535 − alpha). `sum_opaque` is 0 if and only if no fragment is opaque. `sum_axis_x` to `sum_axis_offset`
/// sum normals and offsets of fragments that are turned to one half space (axis_sign()).
enum Sum : int {
  sum_weight,
  sum_red,
  sum_green,
  sum_blue,
  sum_nx,
  sum_ny,
  sum_nz,
  sum_axis_x,
  sum_axis_y,
  sum_axis_z,
  sum_axis_offset,
  sum_offset,
  sum_clear,
  sum_opaque,
  sum_count
};
inline constexpr int opaque_sum_count = sum_clear;

/// Returns true for sums with the weights of surface_weight(). They fit 32 bits where the others need 64 bits.
GB_HD constexpr bool is_narrow_sum(int channel) { return channel >= sum_axis_x && channel <= sum_offset; }

/// Number of fragments that a 64-bit accumulator holds without overflow: each adds at most √3·2^36·65535 < 2^53. A
/// narrow sum then fits 32 bits: each fragment adds at most √2·2^12·128 < 2^20.
inline constexpr int fragments_before_flush = 1024;

/// Returns the weight of a fragment in narrow sums: its area in 2^-12 voxel², at least 1. It is 0 for a fragment that
/// is completely transparent.
GB_HD std::int64_t surface_weight(std::int64_t visible) {
  const std::int64_t weight = visible >> 24;
  return weight > 0 ? weight : (visible > 0 ? 1 : 0);
}

/// Returns -1 or 1, the sign that turns a normal to a fixed half space. Opposite normals have opposite signs, unless
/// they lie on the border of the half space. The border contains no common normal.
GB_HD int axis_sign(const Vec3<std::int16_t>& normal) {
  return 9973 * normal[0] + 17327 * normal[1] + 31469 * normal[2] < 0 ? -1 : 1;
}

/// Calls add(channel, value) for each sum of a fragment. The caller decides where the sums are stored.
template <class Add>
GB_HD void contribute(const Fragment& f, const Add& add) {
  // Transparent parts must not influence the normal, so the normal's weight is scaled by alpha.
  const std::int64_t clear = f.weight * (65535 - f.alpha);
  const std::int64_t visible = clear == 0 ? f.weight : (f.weight * 65535 - clear) / 65535;
  add(sum_weight, f.weight);
  for (int c = 0; c < 3; ++c) add(Sum(sum_red + c), f.colour[c]);
  for (int c = 0; c < 3; ++c) add(Sum(sum_nx + c), visible * f.normal[c]);
  const std::int64_t weight = surface_weight(visible), turned = axis_sign(f.normal) * weight;
  for (int c = 0; c < 3; ++c) add(Sum(sum_axis_x + c), turned * ((f.normal[c] + 128) >> 8));
  add(sum_axis_offset, turned * f.offset);
  add(sum_offset, weight * f.offset);
  clear == 0 ? add(sum_opaque, 1) : add(sum_clear, clear);
}

template <class I>
GB_HD void accumulate(I sums[sum_count], const Fragment& f) {
  contribute(f, [sums](Sum channel, std::int64_t value) { sums[channel] += value; });
}

}  // namespace gigabake::kernels
