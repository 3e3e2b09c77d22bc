/// Shared-memory state of a block that turns the items of a few adjacent bricks into voxels.
#pragma once

#include <cstdint>

#include "core/octree/brick.h"
#include "kernels/body/voxelize/triangle_bricks.h"
#include "kernels/cuda/voxelize/batch.cuh"
#include "kernels/cuda/voxelize/bits.cuh"
#include "kernels/cuda/voxelize/cut.cuh"
#include "kernels/cuda/voxelize/sums.cuh"

namespace gigabake::kernels {

inline constexpr int fill_threads = 128;
inline constexpr int mask_words = 16 * bricks_per_block;

/// Width of sums and size of shared memory in a fill kernel. Bricks that are not hard have at most
/// fragments_before_flush triangles, all of them narrow (is_narrow()). The size permits `blocks` blocks on a
/// multiprocessor with 228 KiB of shared memory.
template <bool is_hard, CellMaterials materials>
struct FillWidth {
  static constexpr int blocks = (is_hard ? 2 : 4) + (all_visible(materials) ? 1 : 0);
  static constexpr std::size_t bytes = (228 * 1024 / blocks - 1024) / 128 * 128;  ///< the driver reserves 1 KiB per
                                                                                  ///< block
  using Sums = VoxelSums<is_hard ? 3 : 2, all_visible(materials) ? opaque_sum_count : sum_count>;
};

/// The block's bricks: their masks, item counts, and the places of their voxels in the output arrays.
struct BlockBricks {
  std::uint32_t prefix[fill_threads];  ///< inclusive prefix sums of the items' cell counts, per warp
  std::uint32_t warp_cells[fill_threads / 32];
  unsigned mask[mask_words];                  ///< bit voxel % 32 of word voxel / 32, brick after brick
  std::uint16_t below[mask_words + 1];        ///< voxels in the preceding words
  std::uint32_t start[bricks_per_block + 1];  ///< first pair of each brick, from the batch's first pair
  std::uint32_t items[bricks_per_block];
  unsigned invisible[bricks_per_block];
  std::uint32_t first_place;  ///< place of the first brick's first voxel; the others follow
};

/// BlockBricks with a memory pool. The voxel sums of a round begin at the pool's start; the items grow downwards from
/// its end. Sums and items share the pool, because some bricks have few triangles and many voxels, and others many
/// triangles and few voxels.
template <bool is_hard, CellMaterials materials>
struct FillShared : BlockBricks {
  using Sums = typename FillWidth<is_hard, materials>::Sums;
  using Item = SlabFragment<is_hard, materials>;
  static constexpr int pool_bytes = (FillWidth<is_hard, materials>::bytes - sizeof(BlockBricks)) / 16 * 16;
  static constexpr int min_items = 8;
  static_assert(pool_bytes >= brick_voxels * int(sizeof(Sums)) + min_items * int(sizeof(Item)));

  alignas(16) unsigned char pool[pool_bytes];

  __device__ Sums& sums(int slot) { return reinterpret_cast<Sums*>(pool)[slot]; }
  __device__ Item& item(int i) { return reinterpret_cast<Item*>(pool + pool_bytes)[-1 - i]; }
  /// Returns the number of items that fit next to the sums of `slots` voxels.
  /// Range   slots ≤ brick_voxels.
  __device__ static std::uint32_t item_capacity(int slots) {
    return smaller(unsigned(fill_threads), unsigned(pool_bytes - slots * int(sizeof(Sums))) / unsigned(sizeof(Item)));
  }
};

/// Returns the number, within the block, of the brick that a pair belongs to.
__device__ inline int brick_of_item(const std::uint32_t start[bricks_per_block + 1], std::uint32_t pair) {
  int brick = 0;
#pragma unroll
  for (int b = 1; b < bricks_per_block; ++b) brick += pair >= start[b];
  return brick;
}

/// Returns the inclusive prefix sum of `mine` over the warp's lanes.
__device__ inline std::uint32_t warp_sums(std::uint32_t mine, int lane) {
#pragma unroll
  for (int d = 1; d < 32; d *= 2) {
    const std::uint32_t before = __shfl_up_sync(~0u, mine, d);
    if (lane >= d) mine += before;
  }
  return mine;
}

/// Computes `shared.below`, the number of voxels in the mask words before each word. The whole block must call it; it
/// synchronizes the block.
__device__ inline void count_voxels(BlockBricks& shared) {
  constexpr int words = mask_words / 32;
  static_assert(mask_words % 32 == 0);
  if (threadIdx.x < 32) {
    const int lane = int(threadIdx.x);
    int mine = 0, before[words];
#pragma unroll
    for (int w = 0; w < words; ++w) {
      before[w] = mine;
      mine += __popc(shared.mask[words * lane + w]);
    }
    const int sum = int(warp_sums(std::uint32_t(mine), lane));
#pragma unroll
    for (int w = 0; w < words; ++w) shared.below[words * lane + w] = std::uint16_t(sum - mine + before[w]);
    if (lane == 31) shared.below[mask_words] = std::uint16_t(sum);
  }
  __syncthreads();
}

/// Removes an invisible voxel from its brick's mask. `rank` is the voxel's number among the block's voxels.
__device__ inline void drop_voxel(std::uint64_t* mask, int rank, BlockBricks& shared) {
  int word = 0;
  while (shared.below[word + 1] <= rank) ++word;
  const int bit = 32 * (word % 2) + nth_bit(shared.mask[word], rank - shared.below[word]);
  atomicAnd(reinterpret_cast<unsigned long long*>(&mask[word / 2]), ~(1ull << bit));
  atomicAdd(&shared.invisible[word / 16], 1u);
}

/// Loads masks, item counts and places of the block's bricks. The whole block must call it; it synchronizes the block.
__device__ inline void open_bricks(const BatchView& view, BrickSpan span, BlockBricks& shared) {
  const std::uint32_t t = threadIdx.x;
  if (t <= bricks_per_block)
    shared.start[t] =
        view.bricks.start[span.first + smaller<std::uint32_t>(t, span.bricks)] - view.bricks.start[view.begin];
  if (t < bricks_per_block) {
    shared.items[t] = t < span.bricks ? view.items_of[span.first - view.begin + t] : 0;
    shared.invisible[t] = 0;
  }
  if (t == 0) shared.first_place = view.place[span.first];
  static_assert(mask_words == fill_threads);
  const auto* mask = reinterpret_cast<const unsigned*>(view.mask + 8 * std::size_t(span.first));
  shared.mask[t] = t < 16 * span.bricks ? mask[t] : 0;
  __syncthreads();
  count_voxels(shared);
}

/// Stores the number of visible voxels of each brick.
__device__ inline void close_bricks(const BatchView& view, BrickSpan span, const BlockBricks& shared) {
  if (threadIdx.x >= span.bricks) return;
  const std::uint32_t b = threadIdx.x, marked = shared.below[16 * b + 16] - shared.below[16 * b];
  view.visible[span.first + b] = marked - shared.invisible[b];
}

}  // namespace gigabake::kernels
