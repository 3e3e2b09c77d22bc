/// Masks of bricks, and of the bricks above them.
#pragma once

#include <cstdint>

namespace gigabake::kernels {

/// Even bits of a row pair, closed up: bit x of the result is bit 2x.
__device__ inline std::uint64_t close_up(std::uint64_t rows) {
  rows &= 0x0055005500550055ull;  // one row in two, one bit in two
  rows = (rows | rows >> 1) & 0x0033003300330033ull;
  rows = (rows | rows >> 2) & 0x000f000f000f000full;
  return rows;  // row y at bits 16 y
}

/// The 4×4 parent voxels that slabs 2z and 2z+1 of a child make: bit x + 8 y.
__device__ inline std::uint64_t parent_slab(std::uint64_t low, std::uint64_t high) {
  std::uint64_t m = low | high;
  m |= m >> 1;
  m |= m >> 8;
  m = close_up(m);
  return (m & 0xf) | (m >> 8 & 0xf00) | (m >> 16 & 0xf0000) | (m >> 24 & 0xf000000);
}

/// Set bits below bit `at`.
__device__ inline std::uint32_t bits_below(std::uint64_t word, int at) {
  return std::uint32_t(__popcll(word & ((std::uint64_t(1) << at) - 1)));
}

/// Bits 0, 3 and 6 of a Morton code: of key, key >> 1 and key >> 2 they are the low bits of x, y and z.
__device__ inline int every_third(std::uint32_t key) { return int((key & 1) | (key >> 2 & 2) | (key >> 4 & 4)); }

}  // namespace gigabake::kernels
