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
/// weight · (65535 − alpha). `sum_opaque` is the narrow area of the opaque fragments; it is 0 if and only if there are
/// none.
///
/// `sum_nx` to `sum_offset` state the voxel's surface. Their weight is surface_weight(). `sum_lower_x` to
/// `sum_lower_offset` sum only fragments of the lower half space (is_lower()). Most voxels have none.
enum Sum : int {
  sum_weight,
  sum_red,
  sum_green,
  sum_blue,
  sum_nx,
  sum_ny,
  sum_nz,
  sum_lower_x,
  sum_lower_y,
  sum_lower_z,
  sum_lower_offset,
  sum_offset,
  sum_clear,
  sum_opaque,
  sum_count
};
inline constexpr int opaque_sum_count = sum_clear;

/// Returns true for sums of rounded terms. They have 32 bits where the others have 64 bits.
GB_HD constexpr bool is_narrow_sum(int channel) {
  return (channel >= sum_lower_x && channel <= sum_offset) || channel == sum_opaque;
}

/// Number of fragments that a 64-bit accumulator holds without overflow: each adds at most √3·2^36·65535 < 2^53.
inline constexpr int fragments_before_flush = 1024;

/// Numbers of low bits that narrow sums omit: of areas, of offsets times areas, and of normals times areas.
inline constexpr int narrow_area_bits = 24, narrow_offset_bits = 14, narrow_normal_bits = 22;
/// Max visible area of a voxel whose narrow sums of offsets and normals fit 32 bits: 4 voxel². In other voxels these
/// sums may wrap around and are ignored.
inline constexpr double max_narrow_area = double(std::int64_t(4) << 36);

/// Returns a fragment's weight in the sums of the surface, in units of Fragment::weight: its visible area. A smaller
/// area than 2^-22 voxel² counts as that, so that narrow sums state its offset exactly.
GB_HD std::int64_t surface_weight(std::int64_t visible) {
  constexpr std::int64_t minimum = std::int64_t(1) << narrow_offset_bits;
  return visible <= 0 || visible >= minimum ? visible : minimum;
}

/// Returns the term of a narrow sum: `term` / 2^bits, rounded to nearest, half up. The product is rounded instead of
/// the area, so that small fragments keep their weight.
GB_HD std::int64_t narrow_term(std::int64_t term, int bits) { return (term + (std::int64_t(1) << (bits - 1))) >> bits; }

/// Tests whether a normal points to a fixed half space. One of two opposite normals does, unless both lie on its
/// border. The border contains no common normal.
GB_HD bool is_lower(const Vec3<std::int16_t>& normal) {
  return 9973 * normal[0] + 17327 * normal[1] + 31469 * normal[2] < 0;
}

/// Calls add(channel, value) for each sum of a fragment. The caller decides where the sums are stored.
template <class Add>
GB_HD void contribute(const Fragment& f, const Add& add) {
  // Transparent parts must not influence the surface, so its weight is scaled by alpha.
  const std::int64_t clear = f.weight * (65535 - f.alpha);
  const std::int64_t area = surface_weight(clear == 0 ? f.weight : (f.weight * 65535 - clear) / 65535);
  const std::int64_t offset = narrow_term(area * f.offset, narrow_offset_bits);
  add(sum_weight, f.weight);
  for (int c = 0; c < 3; ++c) add(Sum(sum_red + c), f.colour[c]);
  for (int c = 0; c < 3; ++c) add(Sum(sum_nx + c), area * f.normal[c]);
  add(sum_offset, offset);
  if (is_lower(f.normal)) {
    for (int c = 0; c < 3; ++c) add(Sum(sum_lower_x + c), narrow_term(area * f.normal[c], narrow_normal_bits));
    add(sum_lower_offset, offset);
  }
  clear == 0 ? add(sum_opaque, 1 + (area >> narrow_area_bits)) : add(sum_clear, clear);
}

template <class I>
GB_HD void accumulate(I sums[sum_count], const Fragment& f) {
  contribute(f, [sums](Sum channel, std::int64_t value) { sums[channel] += value; });
}

}  // namespace gigabake::kernels
