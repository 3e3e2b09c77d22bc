/// Occupancy masks of bricks and of their parents: 8 words, one per slab; bit x + 8y.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"

namespace gigabake::kernels {

GB_HD int bit_count(std::uint64_t word) {
#if defined(__CUDA_ARCH__)
  return __popcll(word);
#else
  return __builtin_popcountll(word);
#endif
}

/// Compacts the even bits of a row pair: bit x of the result is bit 2x; row y at bits 16 y.
GB_HD std::uint64_t close_up(std::uint64_t rows) {
  rows &= 0x0055005500550055ull;  // every second row, every second bit
  rows = (rows | rows >> 1) & 0x0033003300330033ull;
  rows = (rows | rows >> 2) & 0x000f000f000f000full;
  return rows;
}

/// Returns the 4×4 parent voxels of slabs 2z and 2z+1 of a child: bit x + 8 y. A parent voxel exists if one of its
/// eight children does.
GB_HD std::uint64_t parent_slab(std::uint64_t low, std::uint64_t high) {
  std::uint64_t m = low | high;
  m |= m >> 1;
  m |= m >> 8;
  m = close_up(m);
  return (m & 0xf) | (m >> 8 & 0xf00) | (m >> 16 & 0xf0000) | (m >> 24 & 0xf000000);
}

/// Returns the number of set bits below bit `at`.
GB_HD std::uint32_t bits_below(std::uint64_t word, int at) {
  return std::uint32_t(bit_count(word & ((std::uint64_t(1) << at) - 1)));
}

}  // namespace gigabake::kernels
