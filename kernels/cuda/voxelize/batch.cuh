/// A batch of bricks between items and voxels, as the kernels share it.
#pragma once

#include <cstdint>

#include "kernels/cuda/voxelize/items.cuh"

namespace gigabake::kernels {

inline constexpr int bricks_per_block = 8;
/// Groups of more triangles are divided into one block per brick, so that the last blocks do not run long.
inline constexpr std::uint32_t max_pairs_together = 512;

struct BatchCounters {
  unsigned items, heavy, hard;                ///< of the current batch
  unsigned max_items, max_pairs, max_staged;  ///< maxima over the batches
  unsigned long long fragments, voxels;       ///< sums over all batches; voxels: all voxels of items, including
                                              ///< invisible voxels
  unsigned visible;                           ///< visible voxels of the cell; known after the last batch
};

struct BatchView {
  InputView input;
  BricksView bricks;
  ItemView items;
  std::uint32_t begin, end;                 ///< bricks of the batch
  std::uint64_t* mask;                      ///< 8 words per brick: voxels of its items; invisible ones are removed
                                            ///< while the brick is filled
  std::uint32_t *marked, *place, *visible;  ///< per brick: voxels of its items, place of the first one, visible voxels
  std::uint32_t* items_of;                  ///< [brick of the batch]
  std::uint8_t* is_easy;                    ///< [group of bricks_per_block] whether one block fills the group with
                                            ///< 64-bit sums
  std::uint32_t *heavy, *hard;  ///< lists of BrickSpan words. heavy: single bricks, filled first because they take
                                ///< longest; hard: filled with 96-bit sums
  std::uint32_t* rgba;          ///< by place; 0: the voxel is invisible, the place is empty
  std::uint16_t* normal;        ///< by place, or null
  std::uint32_t capacity;       ///< of places
  BatchCounters* counters;
};

/// A range of adjacent bricks that one block fills, packed in one word.
struct BrickSpan {
  std::uint32_t first, bricks;
  __device__ BrickSpan(std::uint32_t first_brick, std::uint32_t count) : first(first_brick), bricks(count) {}
  __device__ explicit BrickSpan(std::uint32_t word) : first(word >> 4), bricks(word & 15) {}
  __device__ std::uint32_t word() const { return first << 4 | bricks; }
};

/// Returns whether the batch's pairs and items fit. Kernels skip a batch that does not; the host enlarges the arrays
/// and retries.
__device__ inline bool items_fit(const BatchView& view) {
  return view.counters->items <= view.items.capacity &&
         view.bricks.start[view.end] - view.bricks.start[view.begin] <= view.items.pairs;
}

/// Computes which voxels the batch's bricks have, and assigns bricks to fill kernels. Launch with 32 threads per brick
/// and bricks_per_block bricks per block.
__global__ void mark_bricks(BatchView view);

}  // namespace gigabake::kernels
