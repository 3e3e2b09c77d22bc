/// How a block turns the items of a few neighbouring bricks into voxels: a thread an item to cut the triangle at its
/// slab, then a thread a fragment for area, shade and sums, then a thread a voxel to resolve. A round takes as many
/// bricks as fill the block's threads and fit its accumulators; a brick that has more voxels takes several rounds.
#pragma once

#include <bit>
#include <cstdint>

#include "kernels/cuda_bits.cuh"
#include "kernels/cuda_cut.cuh"
#include "kernels/cuda_items.cuh"
#include "kernels/cuda_sums.cuh"
#include "kernels/morton.h"
#include "kernels/triangle_bricks.h"

namespace gigabake::kernels {

inline constexpr int bricks_per_block = 8, fill_threads = 128;
inline constexpr int fill_items = 96;  ///< that a block has in hand at a time
inline constexpr int mask_words = 16 * bricks_per_block;

/// A batch's bricks and where their voxels go.
struct FillView {
  InputView input;
  BricksView bricks;
  ItemView items;
  std::uint32_t begin, end;                   ///< bricks of the batch
  std::uint64_t* mask;                        ///< out: 8 per brick
  std::uint32_t *count, *staged, *staged_at;  ///< out: per brick, visible voxels; places in the stage, and the first
  std::uint32_t* stage_rgba;                  ///< 0: nothing visible, the place is empty
  std::uint16_t* stage_normal;                ///< or null
  std::uint32_t stage_capacity;
  struct Counters {
    unsigned staged, items, heavy, hard;           ///< of this batch
    unsigned most_items, most_pairs, most_staged;  ///< of any batch
    unsigned long long fragments, all_staged;
  } * counters;
  std::uint32_t *heavy, *hard;  ///< BrickSpan: filled first, because they take longest; filled with wider integers
  std::uint32_t heavy_capacity;
};

/// Neighbouring bricks that one block fills, in one word.
struct BrickSpan {
  std::uint32_t first, bricks;
  __device__ BrickSpan(std::uint32_t first_brick, std::uint32_t count) : first(first_brick), bricks(count) {}
  __device__ explicit BrickSpan(std::uint32_t word) : first(word >> 4), bricks(word & 15) {}
  __device__ std::uint32_t word() const { return first << 4 | bricks; }
};

/// More triangles than these and every brick has a block of its own: nobody waits long for the last block.
inline constexpr std::uint32_t most_pairs_together = 512;

/// A batch whose items do not fit is skipped; the host makes room and comes back.
__device__ inline bool items_fit(const FillView& view) {
  return view.counters->items <= view.items.capacity &&
         view.bricks.start[view.end] - view.bricks.start[view.begin] <= view.items.pairs;
}

/// How wide integers are: easy bricks have at most fragments_before_flush triangles, all of them narrow. As many slots
/// as leave room for `blocks` in a multiprocessor's shared memory.
template <bool is_hard, bool plain>
struct FillWidth {
  static constexpr int words = is_hard ? 3 : 2, slots = is_hard ? 256 : 304, blocks = plain ? 5 : 4,
                       channels = plain ? opaque_sum_count : sum_count;
};

template <bool is_hard, bool plain>
struct FillShared {
  using Width = FillWidth<is_hard, plain>;
  VoxelSums<Width::words, Width::slots, Width::channels> sums;
  FillItem<is_hard, plain> item[fill_items];
  std::uint32_t prefix[fill_items];  ///< inclusive, of the items' cells
  std::uint32_t warp_cells[fill_threads / 32];
  unsigned mask[mask_words];                  ///< bit voxel % 32 of word voxel / 32, brick after brick
  std::uint16_t below[mask_words + 1];        ///< voxels in the words before
  std::uint32_t start[bricks_per_block + 1];  ///< pairs, of the batch
  std::uint32_t items[bricks_per_block];
  unsigned invisible[bricks_per_block];
  std::uint32_t staged_at;
};

inline constexpr std::uint32_t no_item = ~0u;

__device__ inline int voxel_of_cell(int axis, int slab, int cell) {
  const int bits_u = axis == 2 ? 0 : 3 * axis + 3, bits_v = axis == 0 ? 6 : 3 * axis - 3;
  return slab << 3 * axis | (cell & 7) << bits_u | (cell >> 3) << bits_v;
}

/// Which of the block's bricks a pair belongs to.
__device__ inline int brick_of_item(const std::uint32_t start[bricks_per_block + 1], std::uint32_t pair) {
  int brick = 0;
#pragma unroll
  for (int b = 1; b < bricks_per_block; ++b) brick += pair >= start[b];
  return brick;
}

/// Bit r: row r of the cells has any.
__device__ inline unsigned rows_of(std::uint64_t cells) {
  constexpr std::uint64_t low_bits = 0x7f7f7f7f7f7f7f7full;
  const std::uint64_t any = (((cells & low_bits) + low_bits) | cells) >> 7 & 0x0101010101010101ull;
  return unsigned((any * 0x0102040810204080ull) >> 56);
}

/// Bit c: column c of the cells has any.
__device__ inline unsigned columns_of(std::uint64_t cells) {
  unsigned any = unsigned(cells) | unsigned(cells >> 32);
  any |= any >> 16;
  return (any | any >> 8) & 255;
}

/// The voxels of layer z of a brick, bit x + 8 y, that cells of one slab are. axis: x or y.
__device__ inline std::uint64_t layer_of_cells(std::uint64_t cells, int axis, int slab, int z) {
  if (axis == 0) return spread_row(cells, z) & 0x0101010101010101ull << slab;               // u is y, v is z
  return ((cells >> z & 0x0101010101010101ull) * 0x0102040810204080ull) >> 56 << 8 * slab;  // u is z, v is x
}

__device__ inline void mark_layer(unsigned* mask, std::uint64_t layer) {
  const auto low = std::uint32_t(layer), high = std::uint32_t(layer >> 32);
  if (low != 0) atomicOr(mask, low);
  if (high != 0) atomicOr(mask + 1, high);
}

/// Marks the voxels of the items' cells. True where an item of this thread is wide.
template <class Shared>
__device__ bool mark_voxels(const ItemView& items, ItemRange range, Shared& shared) {
  bool is_wide = false;
  for (std::uint32_t i = range.begin + threadIdx.x; i < range.end; i += fill_threads) {
    const std::uint32_t where = items.where[i];
    const std::uint64_t cells = items.cells[i];
    const int axis = int(where >> 3 & 3), slab = int(where & 7);
    unsigned* mask = shared.mask + 16 * brick_of_item(shared.start, where >> 6);
    is_wide |= (where >> 5 & 1) != 0;
    if (axis == 2) {
      mark_layer(mask + 2 * slab, cells);
      continue;
    }
    for (unsigned layers = axis == 0 ? rows_of(cells) : columns_of(cells); layers != 0; layers &= layers - 1) {
      const int z = __ffs(int(layers)) - 1;
      mark_layer(mask + 2 * z, layer_of_cells(cells, axis, slab, z));
    }
  }
  return is_wide;
}

/// Inclusive sums over the warp.
__device__ inline std::uint32_t warp_sums(std::uint32_t mine, int lane) {
#pragma unroll
  for (int d = 1; d < 32; d *= 2) {
    const std::uint32_t before = __shfl_up_sync(~0u, mine, d);
    if (lane >= d) mine += before;
  }
  return mine;
}

/// Sums of the words before each; returns all voxels. By the whole block.
template <class Shared>
__device__ int count_voxels(Shared& shared) {
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
  return shared.below[mask_words];
}

/// One lane's item, from its triangle.
template <bool is_hard, bool plain>
__device__ void read_item(const FillView& view, std::uint32_t first_brick, std::uint32_t i,
                          const FillShared<is_hard, plain>& shared, FillItem<is_hard, plain>& out) {
  const std::uint32_t where = view.items.where[i], pair = where >> 6;
  out.brick = std::uint8_t(brick_of_item(shared.start, pair));
  out.cells = view.items.cells[i];
  const BrickCoordinate at = demorton(view.bricks.key[first_brick + out.brick]);
  const std::int32_t corner[3] = {std::int32_t(at.x) << brick_subvoxel_bits, std::int32_t(at.y) << brick_subvoxel_bits,
                                  std::int32_t(at.z) << brick_subvoxel_bits};
  const std::uint32_t batch_pair = view.bricks.start[view.begin];
  cut_item(view.input, window_triangle(view.input, view.bricks.triangle[batch_pair + pair]), corner, where, out);
}

/// prefix[] of the chunk's items; returns the number of fragments. By the whole block.
template <class Shared>
__device__ std::uint32_t scan_cells(std::uint32_t cells, Shared& shared) {
  const int lane = int(threadIdx.x & 31), warp = int(threadIdx.x / 32);
  __syncwarp();
  std::uint32_t sum = warp_sums(cells, lane);
  if (lane == 31) shared.warp_cells[warp] = sum;
  __syncthreads();
  for (int w = 0; w < warp; ++w) sum += shared.warp_cells[w];
  if (threadIdx.x < fill_items) shared.prefix[threadIdx.x] = sum;
  __syncthreads();
  return shared.prefix[fill_items - 1];
}

/// The item that fragment f of the chunk belongs to.
__device__ inline int item_of(const std::uint32_t prefix[fill_items], std::uint32_t f) {
  int at = 0;
#pragma unroll
  for (int half = int(std::bit_ceil(unsigned(fill_items))) / 2; half != 0; half /= 2)
    if (at + half <= fill_items && prefix[at + half - 1] <= f) at += half;
  return at;
}

/// An item a thread, or none: cut, then measured and added cell by cell, to the slots from `round` on.
template <bool is_hard, bool plain>
__device__ std::uint32_t add_chunk(const FillView& view, std::uint32_t first_brick, std::uint32_t mine, int round,
                                   FillShared<is_hard, plain>& shared) {
  __syncthreads();  // the last chunk's items are done with
  std::uint32_t cells = 0;
  if (mine != no_item) {
    read_item(view, first_brick, mine, shared, shared.item[threadIdx.x]);
    cells = std::uint32_t(__popcll(shared.item[threadIdx.x].cells));
  }
  const std::uint32_t total = scan_cells(cells, shared);
  for (std::uint32_t f = threadIdx.x; f < total; f += fill_threads) {
    const int at = item_of(shared.prefix, f);
    const FillItem<is_hard, plain>& item = shared.item[at];
    const int cell = nth_bit(item.cells, int(f - (at == 0 ? 0 : shared.prefix[at - 1])));
    const int voxel = voxel_of_cell(item.axis, item.slab, cell), word = 16 * item.brick + (voxel >> 5);
    const int slot = shared.below[word] + __popc(shared.mask[word] & ((1u << (voxel & 31)) - 1)) - round;
    if (slot < 0 || slot >= FillWidth<is_hard, plain>::slots) continue;
    shared.sums.add(slot, fragment_of(view.input, item, cell));
  }
  return total;
}

/// What one round adds up.
struct Round {
  int brick, end;   ///< of the block's bricks
  int first, used;  ///< of the block's voxels
};

/// All items of the round's bricks, a chunk of as many as there are threads at a time, over the ends of groups.
template <bool is_hard, bool plain>
__device__ std::uint32_t add_items(const FillView& view, std::uint32_t first_brick, const Round& round,
                                   FillShared<is_hard, plain>& shared) {
  std::uint32_t fragments = 0;
  ItemWalk walk(view.items, shared.start[round.brick], shared.start[round.end],
                view.bricks.start[view.end] - view.bricks.start[view.begin]);
  while (walk.has_more()) {
    std::uint32_t mine = no_item;
    for (std::uint32_t taken = 0; taken < fill_items && walk.has_more();) {
      const ItemRange range = walk.take(fill_items - taken);
      const std::uint32_t i = threadIdx.x - taken;  // wraps where this thread has an item already
      if (i < range.end - range.begin) mine = range.begin + i;
      taken += range.end - range.begin;
    }
    fragments += add_chunk(view, first_brick, mine, round.first, shared);
  }
  return fragments;
}

/// A voxel without anything visible leaves its brick's mask.
template <class Shared>
__device__ void drop_voxel(std::uint64_t* mask, int rank, Shared& shared) {
  int word = 0;
  while (shared.below[word + 1] <= rank) ++word;
  const int bit = 32 * (word % 2) + nth_bit(shared.mask[word], rank - shared.below[word]);
  atomicAnd(reinterpret_cast<unsigned long long*>(&mask[word / 2]), ~(1ull << bit));
  atomicAdd(&shared.invisible[word / 16], 1u);
}

/// The round's voxels to the stage.
template <class Shared>
__device__ void resolve_round(const FillView& view, std::uint64_t* mask, bool fits, const Round& round,
                              Shared& shared) {
  for (int slot = int(threadIdx.x); slot < round.used; slot += fill_threads) {
    Voxel out;
    const bool visible = shared.sums.resolve_slot(slot, view.input.tables, out);
    if (!visible) drop_voxel(mask, round.first + slot, shared);
    if (!fits) continue;
    const std::uint32_t at = shared.staged_at + std::uint32_t(round.first + slot);
    view.stage_rgba[at] = !visible ? 0
                                   : std::uint32_t(out.rgba[0]) | std::uint32_t(out.rgba[1]) << 8 |
                                         std::uint32_t(out.rgba[2]) << 16 | std::uint32_t(out.rgba[3]) << 24;
    if (view.stage_normal != nullptr && visible)
      view.stage_normal[at] = std::uint16_t(std::uint8_t(out.normal[0]) | std::uint8_t(out.normal[1]) << 8);
  }
}

template <class Shared>
__device__ std::uint32_t count_items(const ItemView& items, std::uint32_t brick, std::uint32_t pairs,
                                     const Shared& shared) {
  std::uint32_t count = 0;
  ItemWalk walk(items, shared.start[brick], shared.start[brick + 1], pairs);
  while (walk.has_more()) {
    const ItemRange range = walk.take(~0u);
    count += range.end - range.begin;
  }
  return count;
}

/// Masks and item counts of the block's bricks, before anything is resolved. False: a thread has a wide item.
template <class Shared>
__device__ bool open_bricks(const FillView& view, BrickSpan span, Shared& shared) {
  const std::uint32_t batch_pair = view.bricks.start[view.begin];
  if (threadIdx.x <= bricks_per_block)
    shared.start[threadIdx.x] =
        view.bricks.start[span.first + smaller<std::uint32_t>(threadIdx.x, span.bricks)] - batch_pair;
  if (threadIdx.x < mask_words) shared.mask[threadIdx.x] = 0;
  if (threadIdx.x < bricks_per_block) shared.invisible[threadIdx.x] = 0;
  __syncthreads();
  bool is_wide = false;
  const std::uint32_t pairs = view.bricks.start[view.end] - batch_pair;
  if (threadIdx.x < bricks_per_block) shared.items[threadIdx.x] = count_items(view.items, threadIdx.x, pairs, shared);
  ItemWalk walk(view.items, shared.start[0], shared.start[bricks_per_block], pairs);
  while (walk.has_more()) is_wide |= mark_voxels(view.items, walk.take(~0u), shared);
  return __syncthreads_or(is_wide) == 0;
}

/// What the host and unstage() want to know of each brick.
template <class Shared>
__device__ void close_bricks(const FillView& view, BrickSpan span, std::uint32_t fragments, const Shared& shared) {
  if (threadIdx.x >= span.bricks) return;
  const std::uint32_t b = threadIdx.x, brick = span.first + b;
  const std::uint32_t staged = shared.below[16 * b + 16] - shared.below[16 * b], count = staged - shared.invisible[b];
  view.count[brick] = count;
  view.staged[brick] = staged;
  view.staged_at[brick] = shared.staged_at + shared.below[16 * b];
  if (b == 0 && fragments != 0) atomicAdd(&view.counters->fragments, (unsigned long long)fragments);
}

/// Where a round ends that begins at `brick`: after one brick, or as many as need neither a second chunk of items nor
/// more slots.
template <int slots, class Shared>
__device__ int round_end(int brick, int bricks, const Shared& shared) {
  std::uint32_t items = shared.items[brick];
  int end = brick + 1;
  for (; end < bricks; ++end) {
    items += shared.items[end];
    if (items > fill_items || shared.below[16 * end + 16] - shared.below[16 * brick] > slots) break;
  }
  return end;
}

/// Bricks [brick, end) of the block, in more than one round where they have more voxels than there are slots; returns
/// their fragments.
template <bool is_hard, bool plain>
__device__ std::uint32_t fill_bricks_of_round(const FillView& view, BrickSpan span, std::uint64_t* mask, int brick,
                                              int end, FillShared<is_hard, plain>& shared) {
  constexpr int slots = FillWidth<is_hard, plain>::slots;
  const int last = shared.below[16 * end];
  std::uint32_t fragments = 0;
  for (int first = shared.below[16 * brick]; first < last; first += slots) {
    const Round round{brick, end, first, smaller(slots, last - first)};
    __syncthreads();
    shared.sums.clear(int(threadIdx.x), fill_threads, round.used);
    __syncthreads();
    fragments = add_items(view, span.first, round, shared);  // the same in each round
    __syncthreads();
    const bool fits = std::uint64_t(shared.staged_at) + std::uint64_t(last) <= view.stage_capacity;
    resolve_round(view, mask, fits, round, shared);
  }
  return fragments;
}

/// The bricks of one block. False, and nothing written: they need wider integers.
template <bool is_hard, bool plain>
__device__ bool fill_bricks(const FillView& view, BrickSpan span, FillShared<is_hard, plain>& shared) {
  constexpr int slots = FillWidth<is_hard, plain>::slots;
  if (!open_bricks(view, span, shared) && !is_hard) return false;
  const int voxels = count_voxels(shared);
  if (threadIdx.x == 0) shared.staged_at = atomicAdd(&view.counters->staged, unsigned(voxels));
  std::uint64_t* mask = view.mask + 8 * std::size_t(span.first);
  if (threadIdx.x < 8 * span.bricks)
    mask[threadIdx.x] = shared.mask[2 * threadIdx.x] | std::uint64_t(shared.mask[2 * threadIdx.x + 1]) << 32;
  std::uint32_t fragments = 0;
  for (int brick = 0; brick < int(span.bricks);) {
    const int end = round_end<slots>(brick, int(span.bricks), shared);
    fragments += fill_bricks_of_round(view, span, mask, brick, end, shared);
    brick = end;
  }
  __syncthreads();
  close_bricks(view, span, fragments, shared);
  return true;
}

}  // namespace gigabake::kernels
