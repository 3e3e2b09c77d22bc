/// Morton (Z-order) codes: interleaved bits of two or three coordinates. x has the lowest bit.
///
/// Exact   Integers: host and device return the same bits.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/math/vec3.h"

namespace gigabake {

/// Moves bit i of v to bit 3i; gather_bits() is the inverse.
/// Range   v < 2^21; higher bits are dropped.
GB_HD std::uint64_t spread_bits(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffull;
  v = (v | v << 16) & 0x1f0000ff0000ffull;
  v = (v | v << 8) & 0x100f00f00f00f00full;
  v = (v | v << 4) & 0x10c30c30c30c30c3ull;
  return (v | v << 2) & 0x1249249249249249ull;
}

GB_HD std::uint32_t gather_bits(std::uint64_t v) {
  v &= 0x1249249249249249ull;
  v = (v | v >> 2) & 0x10c30c30c30c30c3ull;
  v = (v | v >> 4) & 0x100f00f00f00f00full;
  v = (v | v >> 8) & 0x1f0000ff0000ffull;
  v = (v | v >> 16) & 0x1f00000000ffffull;
  return std::uint32_t((v | v >> 32) & 0x1fffff);
}

/// Returns the Morton code of three coordinates.
/// Range   0 … 2^21-1 per axis.
GB_HD std::uint64_t morton(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return spread_bits(x) | spread_bits(y) << 1 | spread_bits(z) << 2;
}

struct BrickCoordinate {
  std::uint32_t x, y, z;

  template <class T>
  GB_HD constexpr explicit operator Vec3<T>() const {
    return {T(x), T(y), T(z)};
  }
};

GB_HD BrickCoordinate demorton(std::uint64_t key) {
  return {gather_bits(key), gather_bits(key >> 1), gather_bits(key >> 2)};
}

/// Returns bits 0, 3 and 6 of a code. For key, key >> 1 and key >> 2, the result is the lowest three bits of x, y and
/// z.
GB_HD int gather_three_bits(std::uint32_t key) { return int((key & 1) | (key >> 2 & 2) | (key >> 4 & 4)); }

/// Moves bit i of v to bit 2i.
GB_HD std::uint64_t spread_bits_2d(std::uint32_t bits) {
  std::uint64_t v = bits;
  v = (v | v << 16) & 0x0000ffff0000ffffull;
  v = (v | v << 8) & 0x00ff00ff00ff00ffull;
  v = (v | v << 4) & 0x0f0f0f0f0f0f0f0full;
  v = (v | v << 2) & 0x3333333333333333ull;
  return (v | v << 1) & 0x5555555555555555ull;
}

/// Returns the Morton code of a column of cells: two coordinates with all 32 bits.
GB_HD std::uint64_t morton(std::uint32_t x, std::uint32_t y) { return spread_bits_2d(x) | spread_bits_2d(y) << 1; }

/// Returns the key of a tree whose nodes have 4×4×4 children. The key repeats two bits each of x, y and z; its lowest
/// bit is that of x.
/// Range   0 … 2^20-1 per axis.
GB_HD std::uint64_t morton_by_pairs(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  const std::uint32_t axis[3] = {x, y, z};
  std::uint64_t key = 0;
  for (int a = 0; a < 3; ++a)
    for (int pair = 0; pair < 10; ++pair) key |= std::uint64_t(axis[a] >> 2 * pair & 3) << (6 * pair + 2 * a);
  return key;
}

}  // namespace gigabake
