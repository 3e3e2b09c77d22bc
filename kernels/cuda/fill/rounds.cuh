/// How a block turns the items of a few neighbouring bricks into voxels: a thread an item to cut the triangle at its
/// slab, then a thread a fragment for area, shade and sums, then a thread a voxel to resolve. A round takes as many
/// bricks as fill the block's threads and fit its memory.
///
/// Warps wait for each other twice a chunk of items: for all that is cut, and for all that is measured. While some
/// resolve the last voxels of a round, others cut the next one's items already.
#pragma once

#include <cstdint>

#include "kernels/cuda/fill/block.cuh"
#include "lattice/brick.h"

namespace gigabake::kernels {

/// Bricks of the block whose voxels are summed at a time.
struct Round {
  int brick, end;
  int first, used;     ///< of the block's voxels
  std::uint32_t room;  ///< items at a time
};

/// As many bricks after the last round's as need no second chunk of items, but at least one.
template <class Shared>
__device__ Round next_round(const Round& last, int bricks, const Shared& shared) {
  Round next{last.end, last.end, shared.below[16 * last.end], 0, 0};
  for (std::uint32_t items = 0; next.end < bricks; ++next.end) {
    const int used = shared.below[16 * next.end + 16] - next.first;
    items += shared.items[next.end];
    if (next.end != next.brick && (used > brick_voxels || items > Shared::item_room(larger(used, last.used)))) break;
    next.used = used;
    next.room = Shared::item_room(larger(used, last.used));
  }
  return next;
}

inline constexpr std::uint32_t no_item = ~0u;

/// The number of this thread's item among the next `room`, or no_item.
__device__ inline std::uint32_t take_item(ItemWalk& walk, std::uint32_t room) {
  std::uint32_t mine = no_item;
  for (std::uint32_t taken = 0; taken < room && walk.has_more();) {
    const ItemRange range = walk.take(room - taken);
    const std::uint32_t i = threadIdx.x - taken;  // wraps where this thread has an item already
    if (i < range.end - range.begin) mine = range.begin + i;
    taken += range.end - range.begin;
  }
  return mine;
}

/// An item that this thread is going to cut, or none: without cells.
struct NextItem {
  std::uint64_t cells = 0;
  std::uint32_t where = 0, triangle = 0;
};

/// What waits least for memory when it is asked for before other work. How many cells a warp's items have is summed
/// while its lanes are still together.
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

/// An item a thread, from its triangle.
template <bool is_hard, CellMaterials materials>
__device__ void cut_chunk(const BatchView& view, std::uint32_t first_brick, const NextItem& next,
                          FillShared<is_hard, materials>& shared) {
  if (next.cells == 0) return;
  FillItem<is_hard, materials>& out = shared.item(int(threadIdx.x));
  out.cells = next.cells;
  out.brick = std::uint8_t(brick_of_item(shared.start, next.where >> 6));
  std::int32_t corner[3];
  brick_corner(view.bricks.key[first_brick + out.brick], corner);
  cut_item(view.input, window_triangle(view.input, next.triangle), corner, next.where, out);
}

/// A fragment of the chunk: which item's, and its number there.
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

/// A warp's way through the chunk's fragments, a lane each: the next ones, or those that wait for their outlines.
struct FragmentWalk {
  std::uint32_t next, total;
  unsigned waiting = 0;

  __device__ bool has_more() const { return next < total || waiting != 0; }
  __device__ Averaging way() const { return waiting >= 32 || next >= total ? Averaging::outline : Averaging::probes; }
};

/// The lane's fragment, or `total`: none.
template <class Shared>
__device__ std::uint32_t take_fragment(FragmentWalk& walk, Averaging way, const Shared& shared) {
  const unsigned lane = threadIdx.x & 31;
  if (way == Averaging::probes) {
    const std::uint32_t f = walk.next + lane;
    walk.next += fill_threads;
    return smaller(f, walk.total);
  }
  const unsigned taken = smaller(walk.waiting, 32u);
  walk.waiting -= taken;
  return lane < taken ? shared.rough[threadIdx.x / 32][walk.waiting + lane] : walk.total;
}

/// By the whole warp.
template <class Shared>
__device__ void let_wait(FragmentWalk& walk, std::uint32_t f, bool rough, Shared& shared) {
  const unsigned who = __ballot_sync(~0u, rough), lane = threadIdx.x & 31;
  __syncwarp();
  if (rough) shared.rough[threadIdx.x / 32][walk.waiting + __popc(who & ((1u << lane) - 1))] = std::uint16_t(f);
  walk.waiting += unsigned(__popc(who));
  __syncwarp();
}

template <bool is_hard, CellMaterials materials>
__device__ bool add_fragment(const BatchView& view, const Round& round, std::uint32_t f, Averaging way,
                             FillShared<is_hard, materials>& shared) {
  const FragmentPlace place = place_of(shared, f);
  const FillItem<is_hard, materials>& item = shared.item(place.item);
  const int cell = nth_bit(item.cells, place.cell);
  bool rough = false;
  const Fragment fragment = fragment_of(view.input.tables, item, cell, way, rough);
  if (rough) return false;
  const int voxel = voxel_of_cell(item.axis, item.slab, cell), word = 16 * item.brick + (voxel >> 5);
  const int slot = shared.below[word] + __popc(shared.mask[word] & ((1u << (voxel & 31)) - 1)) - round.first;
  shared.sums(slot).add(fragment);
  return true;
}

/// The chunk's fragments, cell by cell, measured and added up.
template <bool is_hard, CellMaterials materials>
__device__ void add_chunk(const BatchView& view, const Round& round, FillShared<is_hard, materials>& shared) {
  std::uint32_t total = 0;
  for (const std::uint32_t cells : shared.warp_cells) total += cells;
  if constexpr (materials == CellMaterials::plain) {
    for (std::uint32_t f = threadIdx.x; f < total; f += fill_threads)
      add_fragment(view, round, f, Averaging::probes, shared);
    return;
  } else {
    FragmentWalk walk{threadIdx.x & ~31u, total};
    while (walk.has_more()) {  // one call for both ways: a second copy would not fit the cache of instructions
      const Averaging way = walk.way();
      const std::uint32_t f = take_fragment(walk, way, shared);
      const bool rough = f < total && !add_fragment(view, round, f, way, shared);
      let_wait(walk, f, rough, shared);
    }
  }
}

/// The round's voxels to their places. Leaves sums of zero.
template <bool is_hard, CellMaterials materials>
__device__ void resolve_round(const BatchView& view, BrickSpan span, const Round& round,
                              FillShared<is_hard, materials>& shared) {
  const std::uint32_t first = shared.first_place + std::uint32_t(round.first);
  for (int slot = int(threadIdx.x); slot < round.used; slot += fill_threads) {
    Voxel out;
    const bool visible = shared.sums(slot).resolve_to(view.input.tables, out);
    shared.sums(slot).clear();
    if (!all_show(materials) && !visible)
      drop_voxel(view.mask + 8 * std::size_t(span.first), round.first + slot, shared);
    const std::uint32_t at = first + std::uint32_t(slot);
    if (at >= view.capacity) continue;  // the host counts, makes room and comes back
    view.rgba[at] = visible ? pack_rgba(out.rgba) : 0;
    if (view.normal != nullptr && visible) view.normal[at] = pack_normal(out.normal);
  }
}

/// The bricks of one block.
template <bool is_hard, CellMaterials materials>
__device__ void fill_bricks(const BatchView& view, BrickSpan span, FillShared<is_hard, materials>& shared) {
  open_bricks(view, span, shared);
  const std::uint32_t pairs = view.bricks.start[view.end] - view.bricks.start[view.begin];
  Round round{0, 0, 0, 0, 0};
  ItemWalk walk(view.items, 0, 0, pairs);
  for (;;) {
    const Round last = round;
    const bool ends = !walk.has_more();
    if (ends && last.end != int(span.bricks)) {
      round = next_round(last, int(span.bricks), shared);
      walk = ItemWalk(view.items, shared.start[round.brick], shared.start[round.end], pairs);
    }
    const NextItem next = fetch_item(view, take_item(walk, round.room), shared);
    if (ends) {
      resolve_round(view, span, last, shared);
      if (last.end == int(span.bricks)) break;
      for (int slot = last.used + int(threadIdx.x); slot < round.used; slot += fill_threads) shared.sums(slot).clear();
    }
    cut_chunk(view, span.first, next, shared);
    __syncthreads();
    add_chunk(view, round, shared);
    __syncthreads();
  }
  if (all_show(materials)) return;
  __syncthreads();
  close_bricks(view, span, shared);
}

}  // namespace gigabake::kernels
