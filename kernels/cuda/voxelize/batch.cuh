/// State of a batch of bricks that the kernels share, from the search for items to the voxels.
#pragma once

#include <cstdint>

#include "kernels/cuda/voxelize/items.cuh"

namespace gigabake::kernels {

inline constexpr int bricks_per_block = 8;
/// Max number of pairs of bricks that one block fills together. If a group has more, each of its bricks gets a block,
/// so that the last blocks do not run long.
inline constexpr std::uint32_t max_pairs_together = 512;

struct BatchCounters {
  unsigned long long batch_fragments, batch_voxels;  ///< of the current batch, like the next three members
  unsigned items, heavy, hard;
  unsigned max_items, max_pairs, max_staged;  ///< maxima over the batches
  unsigned long long fragments, voxels;       ///< sums over all finished batches; `voxels` counts all voxels of items,
                                              ///< including invisible voxels
  unsigned visible;                           ///< visible voxels up to the end of the last batch
  unsigned is_stopped;                        ///< 1 after a batch that did not fit; all later batches are skipped
  unsigned next_brick;                        ///< the first brick of the batch that did not fit; set if is_stopped
  unsigned finished_pairs, finished_voxels;   ///< of the bricks before it
};

struct BatchView {
  InputView input;
  BricksView bricks;
  ItemView items;
  std::uint32_t begin, end;                 ///< bricks of the batch
  std::uint64_t* mask;                      ///< 8 words per brick: voxels of its items; invisible voxels are
                                            ///< removed while the brick is filled
  std::uint32_t *marked, *place, *visible;  ///< per brick: voxels of its items, place of the first, visible voxels
  std::uint32_t* items_of;                  ///< number of items per brick of the batch
  std::uint8_t* is_easy;                    ///< [group of bricks_per_block]: 1 if one block fills the group with
                                            ///< 64-bit sums, else 0
  std::uint32_t *heavy, *hard;  ///< lists of BrickSpan words. `heavy` lists single bricks, which are filled first
                                ///< because they take longest; bricks of `hard` are filled with 96-bit sums
  std::uint32_t* rgba;          ///< by place; 0: the voxel is invisible, the place is empty
  std::uint16_t* normal;        ///< by place; null if the cell has no normals
  std::uint32_t* plane;         ///< by place: a DirectionalCoverage; null if lod-0 voxels have no planes
  std::uint32_t capacity;       ///< number of places
  BatchCounters* counters;
};

/// A range of adjacent bricks that one block fills, packed in one word.
struct BrickSpan {
  std::uint32_t first, bricks;
  __device__ BrickSpan(std::uint32_t first_brick, std::uint32_t count) : first(first_brick), bricks(count) {}
  __device__ explicit BrickSpan(std::uint32_t word) : first(word >> 4), bricks(word & 15) {}
  __device__ std::uint32_t word() const { return first << 4 | bricks; }
};

__device__ inline std::uint32_t pairs_of(const BatchView& view) {
  return view.bricks.start[view.end] - view.bricks.start[view.begin];
}

/// Returns true if the batch's pairs and items fit, and no batch before it stopped the level.
__device__ inline bool items_fit(const BatchView& view) {
  return view.counters->is_stopped == 0 && view.counters->items <= view.items.capacity &&
         pairs_of(view) <= view.items.pairs;
}

/// Returns the number of places that the batch and, without staging arrays, the batches before it need. Valid if the
/// items fit.
__device__ inline std::uint32_t places_of(const BatchView& view) {
  return view.place[view.end - 1] + view.marked[view.end - 1];
}

/// Returns true if the batch's items and voxels fit, and the places have 32 bits. Kernels skip a batch that does not
/// fit; the host enlarges the arrays and continues with this batch.
__device__ inline bool batch_fits(const BatchView& view) {
  return items_fit(view) && places_of(view) <= view.capacity && places_of(view) >= view.place[view.begin];
}

/// Computes the masks of the batch's bricks and assigns the bricks to fill kernels. Launch with 32 threads per brick
/// and bricks_per_block bricks per block.
__global__ void mark_bricks(BatchView view);

}  // namespace gigabake::kernels
