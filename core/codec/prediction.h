/// Prediction of a brick's voxels from the voxels of the next coarser level (docs/format.md, "Differences").
///
/// A brick has 64 groups of 2×2×2 voxels. Each group is one voxel of the parent brick, its parent voxel. Groups are
/// numbered by Morton code: bits 0, 1 and 2 are bit 0 of x, y and z, and so on. Eight bits state which voxels of a
/// group exist. Colours and normals are stored as differences from the parent voxel.
///
/// Exact   Integers: host and device return the same bits.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/codec/shared_value.h"
#include "core/octree/brick.h"

namespace gigabake {

/// The number of bricks from one row of the column `first` to the next.
inline constexpr std::uint32_t bricks_per_start = 64;

/// Returns voxel x + 8y + 64z of a brick from its Morton code (9 bits).
GB_HD constexpr unsigned voxel_of_code(unsigned code) {
  const auto gathered = [](unsigned bits) { return (bits & 1) | (bits >> 2 & 2) | (bits >> 4 & 4); };
  return gathered(code) + 8 * gathered(code >> 1) + 64 * gathered(code >> 2);
}

/// Exchanges bits `low` and `high` of the indices of the 64 bits. `chosen` has the bits whose index has bit `low` but
/// not bit `high`.
GB_HD std::uint64_t with_index_bits_swapped(std::uint64_t bits, unsigned low, unsigned high, std::uint64_t chosen) {
  const unsigned distance = (1u << high) - (1u << low);
  const std::uint64_t differ = (bits >> distance ^ bits) & chosen;
  return bits ^ differ ^ differ << distance;
}

/// Returns the 64 bits of an octant of a mask by Morton code. In a brick's own mask, byte n has the voxels of group
/// 8 · octant + n. In the mask of its parent, with the brick's octant, bit n states whether group n has a parent voxel.
GB_HD std::uint64_t codes_of_octant(const std::uint64_t* mask, unsigned octant) {
  std::uint64_t bits = 0;  // x + 4y + 16z
  for (unsigned z = 0; z < 4; ++z) {
    std::uint64_t rows = mask[4 * (octant >> 2) + z] >> (4 * (octant & 1) + 32 * (octant >> 1 & 1)) & 0x0f0f0f0f;
    rows = (rows | rows >> 4) & 0x00ff00ff;
    bits |= ((rows | rows >> 8) & 0xffff) << 16 * z;
  }
  bits = with_index_bits_swapped(bits, 1, 2, 0x0c0c0c0c0c0c0c0cull);
  bits = with_index_bits_swapped(bits, 2, 4, 0x0000f0f00000f0f0ull);
  return with_index_bits_swapped(bits, 3, 4, 0x0000ff000000ff00ull);
}

/// Returns the voxels of a group that exist; bit x + 2y + 4z. `codes` is codes_of_octant() of the octant group / 8.
GB_HD std::uint8_t children_of_group(std::uint64_t codes, unsigned group) {
  return std::uint8_t(codes >> 8 * (group % 8));
}

/// Sets the voxels of an octant in a mask: the inverse of codes_of_octant().
inline void set_octant(std::uint64_t bits, unsigned octant, std::uint64_t* mask) {
  bits = with_index_bits_swapped(bits, 3, 4, 0x0000ff000000ff00ull);
  bits = with_index_bits_swapped(bits, 2, 4, 0x0000f0f00000f0f0ull);
  bits = with_index_bits_swapped(bits, 1, 2, 0x0c0c0c0c0c0c0c0cull);
  for (unsigned z = 0; z < 4; ++z) {
    std::uint64_t rows = bits >> 16 * z & 0xffff;
    rows = (rows | rows << 8) & 0x00ff00ff;
    rows = (rows | rows << 4) & 0x0f0f0f0f;
    mask[4 * (octant >> 2) + z] |= rows << (4 * (octant & 1) + 32 * (octant >> 1 & 1));
  }
}

/// Returns the number of a brick's voxels before `voxel`. `before` has the number of voxels before each mask word.
template <class Count>
GB_HD std::uint32_t rank_of(const std::uint64_t* mask, const Count* before, unsigned voxel) {
  return before[voxel >> 6] + bits_in(mask[voxel >> 6] & ((std::uint64_t(1) << (voxel & 63)) - 1));
}

/// The node above a brick. All bytes of the default value are zero.
struct BrickParent {
  enum Kind : std::uint8_t { none, brick, constant };
  std::uint32_t value = 0;   ///< the number of the brick in its level, or the rgba of the constant node
  std::uint16_t normal = 0;  ///< of the constant node
  Kind kind = none;
  std::uint8_t octant = 0;  ///< the child's position in the parent, x + 2y + 4z
};

/// Returns the number of rows that a brick has in the column `children`. `there` has a bit per group whose parent voxel
/// exists. `is_dense` is true if a voxel of the level has no parent voxel.
GB_HD std::uint32_t children_rows(BrickParent::Kind kind, std::uint64_t there, bool is_dense) {
  return kind != BrickParent::brick || is_dense ? groups_per_brick : bits_in(there);
}
/// Returns true if a group has a row in the column `children`.
GB_HD bool has_children_row(BrickParent::Kind kind, std::uint64_t there, bool is_dense, unsigned group) {
  return kind != BrickParent::brick || is_dense || (there >> group & 1) != 0;
}

/// Returns true if a voxel has a row in the column `facing`. Voxels whose surface is completely on its plane have none,
/// unless `is_complete` states that all voxels of the level have a row.
GB_HD bool stores_coverage(std::uint8_t plane, bool is_complete) { return is_complete || (plane & 3) != 3; }
/// Returns true if a voxel requires that all voxels of its level have a row in the column `facing`. `voxel` is its
/// directional coverage.
GB_HD bool requires_all_coverages(const std::uint8_t* voxel) {
  return !stores_coverage(voxel[3], false) && (voxel[0] | voxel[1] | voxel[2]) != 0;
}

/// Returns the prediction of a voxel's coverages along the axes: zero if its surface is completely on its plane.
GB_HD std::uint8_t predicted_coverage(std::uint8_t plane, std::uint8_t alpha) {
  return stores_coverage(plane, false) ? alpha : std::uint8_t(0);
}

GB_HD std::int32_t signed_byte(std::uint32_t value) { return std::int32_t((value + 128) & 255) - 128; }

/// Returns the stored difference of a colour from its prediction, three bytes, the first lowest: YCoCg-R of the
/// differences modulo 256. `rgb` and `predicted` have r, g, b from the lowest byte; higher bytes are ignored.
/// Source  Malvar, Sullivan and Srinivasan 2008, "Lifting-based reversible color transformations".
GB_HD std::uint32_t colour_difference(std::uint32_t rgb, std::uint32_t predicted) {
  const std::uint32_t r = rgb - predicted, g = (rgb >> 8) - (predicted >> 8), b = (rgb >> 16) - (predicted >> 16);
  const std::int32_t co = signed_byte(r - b);
  const std::uint32_t t = b + std::uint32_t(co >> 1);
  const std::int32_t cg = signed_byte(g - t);
  const std::uint32_t y = t + std::uint32_t(cg >> 1);
  return (y & 255) | (std::uint32_t(co) & 255) << 8 | (std::uint32_t(cg) & 255) << 16;
}

/// Inverse of colour_difference(). Returns three bytes, r lowest.
GB_HD std::uint32_t colour_from_difference(std::uint32_t difference, std::uint32_t predicted) {
  const std::int32_t co = signed_byte(difference >> 8), cg = signed_byte(difference >> 16);
  const std::uint32_t t = difference - std::uint32_t(cg >> 1), g = t + std::uint32_t(cg);
  const std::uint32_t b = t - std::uint32_t(co >> 1), r = b + std::uint32_t(co);
  return ((r + predicted) & 255) | ((g + (predicted >> 8)) & 255) << 8 | ((b + (predicted >> 16)) & 255) << 16;
}

/// Returns the difference of two normals modulo 256, byte by byte. normal_from_difference() is the inverse.
GB_HD std::uint16_t normal_difference(std::uint32_t normal, std::uint32_t predicted) {
  return std::uint16_t(((normal - predicted) & 255) | (((normal >> 8) - (predicted >> 8)) & 255) << 8);
}
GB_HD std::uint16_t normal_from_difference(std::uint32_t difference, std::uint32_t predicted) {
  return std::uint16_t(((difference + predicted) & 255) | (((difference >> 8) + (predicted >> 8)) & 255) << 8);
}

}  // namespace gigabake
