#include "kernels/body/voxelize/accumulate.h"
#include "kernels/cuda/voxelize/batch.cuh"

namespace gigabake::kernels {
namespace {

/// Sums over those items of the warp's brick that one lane processes.
struct MarkedItems {
  std::uint32_t cells = 0;
  bool is_wide = false;
};

__device__ void mark_item(const ItemView& items, std::uint32_t i, unsigned mask[16], MarkedItems& all) {
  const std::uint32_t where = items.where[i];
  const std::uint64_t cells = items.cells[i];
  const int axis = int(where >> 3 & 3), slab = int(where & 7);
  all.is_wide |= (where >> 5 & 1) != 0;
  all.cells += std::uint32_t(__popcll(cells));
  if (axis == 2) {  // the slab's cells are the bits of a mask word
    atomicOr(mask + 2 * slab, std::uint32_t(cells));
    atomicOr(mask + 2 * slab + 1, std::uint32_t(cells >> 32));
    return;
  }
  for (std::uint64_t rest = cells; rest != 0; rest &= rest - 1) {
    const int voxel = voxel_of_cell(axis, slab, __ffsll((long long)rest) - 1);
    atomicOr(mask + (voxel >> 5), 1u << (voxel & 31));
  }
}

/// Masks and counts of a block's bricks.
struct MarkedBlock {
  unsigned mask[bricks_per_block][16];
  unsigned wide;  ///< bit b: brick b has a wide item
  unsigned cells, voxels;
};

/// Computes the brick's mask from its items, by one warp.
__device__ void mark_brick(const BatchView& view, std::uint32_t brick, MarkedBlock& block) {
  const unsigned lane = threadIdx.x & 31, warp = threadIdx.x / 32;
  unsigned* mask = block.mask[warp];
  const std::uint32_t first = view.bricks.start[view.begin], pairs = view.bricks.start[view.end] - first;
  FragmentIterator walk(view.items, view.bricks.start[brick] - first, view.bricks.start[brick + 1] - first, pairs);
  std::uint32_t items = 0;
  MarkedItems all;
  while (walk.has_more()) {
    const ItemRange range = walk.take(~0u);
    items += range.end - range.begin;
    for (std::uint32_t i = range.begin + lane; i < range.end; i += 32) mark_item(view.items, i, mask, all);
  }
  __syncwarp();
  const std::uint32_t voxels = __reduce_add_sync(~0u, lane < 16 ? std::uint32_t(__popc(mask[lane])) : 0),
                      cells = __reduce_add_sync(~0u, all.cells);
  const bool is_wide = __any_sync(~0u, all.is_wide) != 0;
  if (lane < 8) view.mask[8 * std::size_t(brick) + lane] = mask[2 * lane] | std::uint64_t(mask[2 * lane + 1]) << 32;
  if (lane != 0) return;
  view.marked[brick] = voxels;
  view.items_of[brick - view.begin] = items;
  atomicAdd(&block.cells, cells);
  atomicAdd(&block.voxels, voxels);
  if (is_wide) atomicOr(&block.wide, 1u << warp);
}

__device__ void push(std::uint32_t* list, unsigned& count, BrickSpan span) {
  list[atomicAdd(&count, 1u)] = span.word();
}

/// Assigns a group of bricks to fill kernels. Bit b of `wide` is set if brick b has a wide item.
__device__ void assign_group(const BatchView& view, std::uint32_t group, unsigned wide) {
  const std::uint32_t first = view.begin + group * bricks_per_block,
                      bricks = smaller<std::uint32_t>(bricks_per_block, view.end - first);
  const std::uint32_t* start = view.bricks.start + first;
  const bool together = start[bricks] - start[0] <= max_pairs_together;
  view.is_easy[group] = together && wide == 0;
  if (together && wide != 0) push(view.hard, view.counters->hard, BrickSpan(first, bricks));
  for (std::uint32_t b = 0; !together && b < bricks; ++b) {
    const bool is_hard = (wide >> b & 1) != 0 || start[b + 1] - start[b] > std::uint32_t(fragments_before_flush);
    push(is_hard ? view.hard : view.heavy, is_hard ? view.counters->hard : view.counters->heavy,
         BrickSpan(first + b, 1));
  }
}

}  // namespace

__global__ void __launch_bounds__(32 * bricks_per_block) mark_bricks(BatchView view) {
  __shared__ MarkedBlock block;
  if (!items_fit(view)) return;
  const std::uint32_t warp = threadIdx.x / 32, lane = threadIdx.x & 31,
                      brick = view.begin + blockIdx.x * bricks_per_block + warp;
  if (threadIdx.x == 0) block.wide = block.cells = block.voxels = 0;
  if (lane < 16) block.mask[warp][lane] = 0;
  __syncthreads();
  if (brick < view.end) mark_brick(view, brick, block);
  __syncthreads();
  if (threadIdx.x != 0) return;
  assign_group(view, blockIdx.x, block.wide);
  atomicAdd(&view.counters->batch_fragments, (unsigned long long)block.cells);
  atomicAdd(&view.counters->batch_voxels, (unsigned long long)block.voxels);
}

}  // namespace gigabake::kernels
