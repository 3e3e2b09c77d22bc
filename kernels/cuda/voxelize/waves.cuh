/// Conversion of the items of a few adjacent bricks into voxels, by one block. One thread per item cuts the triangle at
/// its slab. One thread per fragment computes area, colour and sums. One thread per voxel resolves the sums. A round is
/// a group of bricks whose sums and items fit the block's memory together and occupy its threads.
///
/// Warps synchronize twice per chunk of items: after cutting and after measuring. While some warps resolve the last
/// voxels of a round, others already cut the items of the next.
#pragma once

#include <cstdint>

#include "core/octree/brick.h"
#include "kernels/cuda/voxelize/block.cuh"

namespace gigabake::kernels {

/// The bricks of the block whose voxels are summed at the same time.
struct Wave {
  int brick, end;
  int first, used;                ///< first voxel in the block, and number of voxels
  std::uint32_t items_per_chunk;  ///< items per chunk
};

/// Returns the next round: the max number of bricks that need only one chunk of items, but at least one brick.
template <class Shared>
__device__ Wave next_wave(const Wave& last, int bricks, const Shared& shared) {
  Wave next{last.end, last.end, shared.below[16 * last.end], 0, 0};
  for (std::uint32_t items = 0; next.end < bricks; ++next.end) {
    const int used = shared.below[16 * next.end + 16] - next.first;
    items += shared.items[next.end];
    if (next.end != next.brick && (used > brick_voxels || items > Shared::item_capacity(larger(used, last.used))))
      break;
    next.used = used;
    next.items_per_chunk = Shared::item_capacity(larger(used, last.used));
  }
  return next;
}

inline constexpr std::uint32_t no_item = ~0u;

/// Returns this thread's item among the next `items_per_chunk` items, or no_item.
__device__ inline std::uint32_t take_item(FragmentIterator& walk, std::uint32_t items_per_chunk) {
  std::uint32_t mine = no_item;
  for (std::uint32_t taken = 0; taken < items_per_chunk && walk.has_more();) {
    const ItemRange range = walk.take(items_per_chunk - taken);
    const std::uint32_t i = threadIdx.x - taken;  // wraps around if this thread already has an item
    if (i < range.end - range.begin) mine = range.begin + i;
    taken += range.end - range.begin;
  }
  return mine;
}

/// The next item that this thread will cut. If there is none, `cells` is 0.
struct NextItem {
  std::uint64_t cells = 0;
  std::uint32_t where = 0, triangle = 0;
};

/// Loads the next item early, to hide the latency of memory behind other work. Also computes the prefix sums of the
/// cells of the warp's items, because the warp's lanes are converged here.
__device__ inline NextItem fetch_item(const BatchView& view, std::uint32_t mine, BlockBricks& shared) {
  NextItem next;
  if (mine != no_item) {
    next.cells = view.items.cells[mine];
    next.where = view.items.where[mine];
  }
  __syncwarp();
  const int lane = int(threadIdx.x & 31);
  const std::uint32_t sum = warp_sums(std::uint32_t(__popcll(next.cells)), lane);
  shared.prefix[threadIdx.x] = sum;
  if (lane == 31) shared.warp_cells[threadIdx.x / 32] = sum;
  if (mine != no_item) next.triangle = view.bricks.triangle[view.bricks.start[view.begin] + (next.where >> 6)];
  return next;
}

/// Cuts one item per thread from its triangle.
template <bool is_hard, CellMaterials materials>
__device__ void cut_chunk(const BatchView& view, std::uint32_t first_brick, const NextItem& next,
                          FillShared<is_hard, materials>& shared) {
  if (next.cells == 0) return;
  SlabFragment<is_hard, materials>& out = shared.item(int(threadIdx.x));
  out.cells = next.cells;
  out.brick = std::uint8_t(brick_of_item(shared.start, next.where >> 6));
  const Vec3<std::int32_t> corner = brick_corner(view.bricks.key[first_brick + out.brick]);
  cut_item(view.input, window_triangle(view.input, next.triangle), corner, next.where, out);
}

/// A fragment of the chunk: its item and its number among the item's cells.
struct FragmentPlace {
  int item, cell;
};

__device__ inline FragmentPlace place_of(const BlockBricks& shared, std::uint32_t f) {
  int warp = 0;
  std::uint32_t before = 0;
#pragma unroll
  for (int w = 0; w + 1 < fill_threads / 32; ++w) {
    const std::uint32_t end = before + shared.warp_cells[w];
    if (warp == w && f >= end) {
      before = end;
      ++warp;
    }
  }
  const std::uint32_t* prefix = shared.prefix + 32 * warp;
  const std::uint32_t mine = f - before;
  int at = 0;
#pragma unroll
  for (int half = 16; half != 0; half /= 2)
    if (prefix[at + half - 1] <= mine) at += half;
  return {32 * warp + at, int(at == 0 ? mine : mine - prefix[at - 1])};
}

/// Measures the chunk's fragments and adds them to the sums of their voxels.
template <bool is_hard, CellMaterials materials>
__device__ void add_chunk(const BatchView& view, const Wave& wave, FillShared<is_hard, materials>& shared) {
  std::uint32_t total = 0;
  for (const std::uint32_t cells : shared.warp_cells) total += cells;
  for (std::uint32_t f = threadIdx.x; f < total; f += fill_threads) {
    const FragmentPlace place = place_of(shared, f);
    const SlabFragment<is_hard, materials>& item = shared.item(place.item);
    const int cell = nth_bit(item.cells, place.cell);
    const int voxel = voxel_of_cell(item.axis, item.slab, cell), word = 16 * item.brick + (voxel >> 5);
    const int slot = shared.below[word] + __popc(shared.mask[word] & ((1u << (voxel & 31)) - 1)) - wave.first;
    shared.sums(slot).add(fragment_of(view.input.tables, item, cell));
  }
}

/// Resolves the round's voxels and stores them at their places. Clears the sums.
template <bool is_hard, CellMaterials materials>
__device__ void resolve_wave(const BatchView& view, BrickSpan span, const Wave& wave,
                             FillShared<is_hard, materials>& shared) {
  const std::uint32_t first = shared.first_place + std::uint32_t(wave.first);
  for (int slot = int(threadIdx.x); slot < wave.used; slot += fill_threads) {
    FinestVoxel out;
    const bool visible = shared.sums(slot).resolve_to(view.input.tables, out);
    shared.sums(slot).clear();
    if (!all_visible(materials) && !visible)
      drop_voxel(view.mask + 8 * std::size_t(span.first), wave.first + slot, shared);
    const std::uint32_t at = first + std::uint32_t(slot);
    view.rgba[at] = visible ? pack_rgba(out.voxel.rgba) : 0;
    if (view.normal != nullptr && visible) view.normal[at] = pack_normal(out.voxel.normal);
    if (view.plane != nullptr && visible)
      view.plane[at] = std::uint32_t(out.plane) << 8 * int(directional_coverage_plane);
  }
}

/// Fills the bricks of one block.
template <bool is_hard, CellMaterials materials>
__device__ void fill_bricks(const BatchView& view, BrickSpan span, FillShared<is_hard, materials>& shared) {
  open_bricks(view, span, shared);
  const std::uint32_t pairs = view.bricks.start[view.end] - view.bricks.start[view.begin];
  Wave wave{0, 0, 0, 0, 0};
  FragmentIterator walk(view.items, 0, 0, pairs);
  for (;;) {
    const Wave last = wave;
    const bool ends = !walk.has_more();
    if (ends && last.end != int(span.bricks)) {
      wave = next_wave(last, int(span.bricks), shared);
      walk = FragmentIterator(view.items, shared.start[wave.brick], shared.start[wave.end], pairs);
    }
    const NextItem next = fetch_item(view, take_item(walk, wave.items_per_chunk), shared);
    if (ends) {
      resolve_wave(view, span, last, shared);
      if (last.end == int(span.bricks)) break;
      for (int slot = last.used + int(threadIdx.x); slot < wave.used; slot += fill_threads) shared.sums(slot).clear();
    }
    cut_chunk(view, span.first, next, shared);
    __syncthreads();
    add_chunk(view, wave, shared);
    __syncthreads();
  }
  if (all_visible(materials)) return;
  __syncthreads();
  close_bricks(view, span, shared);
}

}  // namespace gigabake::kernels
