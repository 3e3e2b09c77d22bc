/// A batch of bricks on its way from items to voxels, as the kernels share it.
#pragma once

#include <cstdint>

#include "kernels/cuda/fill/items.cuh"

namespace gigabake::kernels {

inline constexpr int bricks_per_block = 8;
/// More triangles than these and every brick has a block of its own: nobody waits long for the last block.
inline constexpr std::uint32_t most_pairs_together = 512;

struct BatchCounters {
  unsigned items, heavy, hard;                   ///< of this batch
  unsigned most_items, most_pairs, most_staged;  ///< of any batch
  unsigned long long fragments, voxels;          ///< of all batches so far; voxels: marked, invisible ones included
  unsigned visible;  ///< voxels of the whole cell that show; known when the last batch has been filled
};

struct BatchView {
  InputView input;
  BricksView bricks;
  ItemView items;
  std::uint32_t begin, end;                 ///< bricks of the batch
  std::uint64_t* mask;                      ///< 8 per brick: its items' voxels; those that turn out invisible leave it
  std::uint32_t *marked, *place, *visible;  ///< per brick: voxels of its items, where the first one goes, how many show
  std::uint32_t* items_of;                  ///< [brick of the batch]
  std::uint8_t* is_easy;                    ///< [group of bricks_per_block] filled together, with narrow integers
  std::uint32_t *heavy, *hard;  ///< BrickSpan: filled first, because they take longest; filled with wider integers
  std::uint32_t* rgba;          ///< by place; 0: nothing visible, the place is empty
  std::uint16_t* normal;        ///< by place, or null
  std::uint32_t capacity;       ///< of places
  BatchCounters* counters;
};

/// Neighbouring bricks that one block fills, in one word.
struct BrickSpan {
  std::uint32_t first, bricks;
  __device__ BrickSpan(std::uint32_t first_brick, std::uint32_t count) : first(first_brick), bricks(count) {}
  __device__ explicit BrickSpan(std::uint32_t word) : first(word >> 4), bricks(word & 15) {}
  __device__ std::uint32_t word() const { return first << 4 | bricks; }
};

/// A batch whose pairs or items do not fit is skipped; the host makes room and comes back.
__device__ inline bool items_fit(const BatchView& view) {
  return view.counters->items <= view.items.capacity &&
         view.bricks.start[view.end] - view.bricks.start[view.begin] <= view.items.pairs;
}

/// Which voxels the batch's bricks have, and who fills them. Launch with 32 threads a brick, bricks_per_block a block.
__global__ void mark_bricks(BatchView view);

}  // namespace gigabake::kernels
