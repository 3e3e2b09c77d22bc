/// Occupancy masks of bricks and of their parents. A mask has eight words, one per z. Voxel (x, y, z) is bit x + 8y of
/// word z.
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

/// Keeps every second bit of every second 8-bit row. Bit 2x of row 2y moves to bit x + 16y, and all other bits are 0.
GB_HD std::uint64_t close_up(std::uint64_t rows) {
  rows &= 0x0055005500550055ull;  // every second row, every second bit
  rows = (rows | rows >> 1) & 0x0033003300330033ull;
  rows = (rows | rows >> 2) & 0x000f000f000f000full;
  return rows;
}

/// Returns the 4×4 parent voxels of slabs 2z (`low`) and 2z + 1 (`high`) of a brick. Parent voxel (x, y) is bit x + 8y.
/// It exists if one of its eight children exists.
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
