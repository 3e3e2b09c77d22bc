/// The exact overlap of a batch's pairs: one thread a pair, its answer slab by slab.
#pragma once

#include <cstdint>

#include "kernels/cuda_bin.cuh"

namespace gigabake::kernels {

/// Pairs are worked on in groups of a block's size; a group's items stand together, in the order of its pairs.
inline constexpr unsigned pairs_per_group = 256;

/// An item is what a triangle touches of one slab of a brick: 64 cells across its dominant axis.
struct ItemView {
  std::uint64_t* cells;      ///< bit u + 8 v
  std::uint32_t* where;      ///< pair (of the batch) << 6 | wide << 5 | axis << 3 | slab; wide: needs 128 bits
  std::uint32_t* first;      ///< [pair of the batch] its first item
  std::uint32_t* group_end;  ///< [group] where its items end
  std::uint32_t capacity;    ///< of cells and where
  std::uint32_t pairs;       ///< capacity of first
  std::uint32_t* count;      ///< items so far; goes on when they do not fit
};

/// Bricks and their triangles, as BrickLists.
struct BricksView {
  const std::uint32_t *key, *start, *triangle;
};

/// Items of the bricks [begin, end). Launch with pairs_per_group threads a block and any number of blocks.
__global__ void find_items(InputView in, SurfaceRule rule, BricksView bricks, std::uint32_t begin, std::uint32_t end,
                           ItemView items);

}  // namespace gigabake::kernels
