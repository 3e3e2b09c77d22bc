/// Morton (Z-order) codes of brick coordinates: x is the lowest bit. Range: 0 … 2^21-1 an axis.
#pragma once

#include <cstdint>

#include "lattice/host_device.h"

namespace gigabake {

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

GB_HD std::uint64_t morton(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return spread_bits(x) | spread_bits(y) << 1 | spread_bits(z) << 2;
}

struct BrickCoordinate {
  std::uint32_t x, y, z;
};

GB_HD BrickCoordinate demorton(std::uint64_t key) {
  return {gather_bits(key), gather_bits(key >> 1), gather_bits(key >> 2)};
}

}  // namespace gigabake
