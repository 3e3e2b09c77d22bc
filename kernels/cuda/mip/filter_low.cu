#include "core/base/rules.h"
#include "core/octree/brick.h"
#include "core/octree/morton.h"
#include "kernels/cuda/mip/filter_low.cuh"

namespace gigabake::kernels {
namespace {

/// Max number of lod-1 bricks that a block filters together, and max numbers of their voxels at lods 1 to 3. If the
/// voxels do not fit, the block filters its bricks one after the other.
constexpr int max_bricks = 4, max_voxels_1 = 512, max_voxels_2 = 128, max_voxels_3 = 8 * max_bricks;
constexpr int blocks = 8;  ///< per multiprocessor
constexpr int at_3 = max_voxels_2, at_4 = at_3 + max_voxels_3, max_above = at_4 + max_bricks;
static_assert(filter_threads == 32 * max_bricks && max_voxels_1 >= brick_voxels && max_voxels_2 >= 64);

using Slots = Children<std::uint16_t>;

/// State of the block's bricks [0, max_bricks) of lod 1. Arrays by level begin with lod 1.
struct LowShared {
  union {
    std::uint32_t raster_1[max_voxels_1][raster_words(2)];
    alignas(16) std::uint32_t raster_3[max_voxels_3][raster_words(8)];  ///< replaces raster_1 once lod 2 is done
  };
  alignas(16) std::uint32_t raster_2[max_voxels_2][raster_words(4)];
  union {
    SurfaceMoments patch_1[max_voxels_1];
    struct {  ///< replaces patch_1 once lod 2 is done
      alignas(16) std::uint32_t raster_4[max_bricks][raster_words(8)];
      ColumnSums sums[max_voxels_3];
    };
  };
  // Arrays of max_above slots hold voxels: lod 2 from slot 0 on, lod 3 from at_3 on, lod 4 from at_4 on. The voxels of
  // a level are ordered by the lod-1 brick in whose cube they lie.
  Slots children[max_above];       ///< numbers of the children, counted per level from the group's first voxel
  std::uint32_t index[max_above];  ///< index of the voxel in its level
  std::uint32_t rgba[max_above];
  std::uint16_t normal[max_above];
  SurfaceMoments patch[at_4];               ///< patches of lods 2 and 3
  std::uint64_t mask[4][max_bricks][8];     ///< [level]: mask of the brick, or of the coarser brick that contains it
  std::uint32_t before[4][max_bricks][8];   ///< index in the level of the first voxel of each mask word
  std::uint32_t child[max_bricks][8];       ///< [octant]: brick of lod 0
  std::uint32_t first_0[max_bricks][8][4];  ///< index of the first voxel of lod 0 of each slab pair
  std::uint32_t corner[max_bricks];         ///< Morton key of the brick
  std::uint16_t slab_2[max_bricks][4];      ///< mask of the lod-2 voxels in the brick, bit x + 4y of each slab
  std::uint16_t slab_3[max_bricks][2];      ///< mask of the lod-3 voxels, bit x + 2y
  std::uint16_t before_2[4 * max_bricks + 1], before_3[2 * max_bricks + 1];  ///< voxels of the block before each slab
  std::uint16_t list_1[max_voxels_1];                                        ///< brick · 512 + voxel
  std::uint8_t list_2[max_voxels_2];                                         ///< brick · 64 + x + 4y + 16z
};

/// Bricks [begin, end) of the block, and their voxels per level.
struct Group {
  int begin, end;
  std::uint32_t first_1;  ///< index in lod 1 of the first voxel
  int n1, n2, n3;
};

__device__ Group group_of(const LowShared& s, int begin, int end) {
  const std::uint32_t first = s.before[0][begin][0];
  return {begin,
          end,
          first,
          int(s.before[0][end - 1][7] + std::uint32_t(__popcll(s.mask[0][end - 1][7])) - first),
          s.before_2[4 * end] - s.before_2[4 * begin],
          s.before_3[2 * end] - s.before_3[2 * begin]};
}

/// Loads the masks of the bricks and of the coarser bricks that contain them, one warp per level. The warp of lod 1
/// also loads the bricks' children.
__device__ void open_bricks(const LowLevels& in, LowShared& s) {
  const int level = int(threadIdx.x) / 32, lane = int(threadIdx.x) % 32, b = lane / 8, w = lane % 8;
  const std::uint32_t p = blockIdx.x * max_bricks + std::uint32_t(b);
  const bool there = p < in.bricks && level < in.levels;
  const LowLevel& up = in.level[level];
  const std::uint32_t brick = !there ? 0 : level == 0 ? p : in.ancestors[p].brick[level - 1];
  const std::uint64_t mask = there ? up.mask[8 * std::size_t(brick) + w] : 0;
  std::uint32_t upto = std::uint32_t(__popcll(mask));
#pragma unroll
  for (int d = 1; d < 8; d *= 2) {
    const std::uint32_t lower = __shfl_up_sync(~0u, upto, d, 8);
    if (w >= d) upto += lower;
  }
  s.mask[level][b][w] = mask;
  s.before[level][b][w] = (there ? up.first[brick] : 0) + upto - std::uint32_t(__popcll(mask));
  if (level != 0) return;
  const std::uint32_t begin = there ? in.start[p] : 0;
  const std::uint32_t end = !there ? 0 : p + 1 == in.bricks ? in.fine.bricks : in.start[p + 1];
  s.child[b][w] = UINT32_MAX;
  __syncwarp();
  if (begin + std::uint32_t(w) < end) s.child[b][in.fine.key[begin + w] & 7] = begin + std::uint32_t(w);
  if (w == 0) s.corner[b] = there ? in.key[p] : 0;
}

/// Computes the masks of lods 2 and 3. The first 4 · max_bricks threads must call it.
__device__ void open_slabs(LowShared& s) {
  constexpr unsigned lanes = (1u << 4 * max_bricks) - 1;
  const int t = int(threadIdx.x), b = t / 4, z = t % 4;
  const std::uint64_t rows = parent_slab(s.mask[0][b][2 * z], s.mask[0][b][2 * z + 1]);
  const auto slab = std::uint32_t((rows & 0xf) | (rows >> 4 & 0xf0) | (rows >> 8 & 0xf00) | (rows >> 12 & 0xf000));
  std::uint32_t half = slab | slab >> 1;
  half |= half >> 4;
  half = (half & 1) | (half >> 1 & 2) | (half >> 6 & 4) | (half >> 7 & 8);  // bits 0, 2, 8, 10
  half |= __shfl_down_sync(lanes, half, 1, 2);
  int upto_2 = __popc(slab), upto_3 = z % 2 == 0 ? __popc(half) : 0;
#pragma unroll
  for (int d = 1; d < 4 * max_bricks; d *= 2) {
    const int lower_2 = __shfl_up_sync(lanes, upto_2, d, 16), lower_3 = __shfl_up_sync(lanes, upto_3, d, 16);
    if (t >= d) upto_2 += lower_2, upto_3 += lower_3;
  }
  s.slab_2[b][z] = std::uint16_t(slab);
  s.before_2[t + 1] = std::uint16_t(upto_2);
  if (t == 0) s.before_2[0] = s.before_3[0] = 0;
  if (z % 2 != 0) return;
  s.slab_3[b][z / 2] = std::uint16_t(half);
  s.before_3[t / 2 + 1] = std::uint16_t(upto_3);
}

/// Computes the index of the first voxel of each slab pair of the children, and calls open_slabs().
__device__ void open_children(const LowLevels& in, LowShared& s) {
  const int t = int(threadIdx.x), b = t / 32, octant = t % 32 / 4, pair = t % 4;
  const std::uint32_t child = s.child[b][octant];
  if (child != UINT32_MAX) {
    std::uint32_t below = in.fine.first[child];
    for (int w = 0; w < 2 * pair; ++w) below += std::uint32_t(__popcll(in.fine.mask[8 * std::size_t(child) + w]));
    s.first_0[b][octant][pair] = below;
  }
  if (t < 4 * max_bricks) open_slabs(s);
}

/// Returns the index in `level` of the voxel at (x, y, z) in the cube of brick b. The cube has 2^bits voxels of `level`
/// per axis.
__device__ std::uint32_t index_of(const LowShared& s, int level, int b, int bits, int x, int y, int z) {
  const std::uint32_t key = s.corner[b];
  x = (gather_three_bits(key) << bits | x) & 7;
  y = (gather_three_bits(key >> 1) << bits | y) & 7;
  z = (gather_three_bits(key >> 2) << bits | z) & 7;
  return s.before[level][b][z] + bits_below(s.mask[level][b][z], x + 8 * y);
}

/// Lists the voxels of lods 1 and 2; each thread lists up to 16 voxels of lod 1 and 2 of lod 2.
__device__ void list_voxels(const Group& g, LowShared& s) {
  const int b = int(threadIdx.x) / 32, lane = int(threadIdx.x) % 32;
  if (b < g.begin || b >= g.end) return;
  const std::uint64_t word = s.mask[0][b][lane / 4];
  const int from = 16 * (lane % 4);
  std::uint32_t slot = s.before[0][b][lane / 4] - g.first_1 + bits_below(word, from);
  for (std::uint32_t rest = std::uint32_t(word >> from) & 0xffff; rest != 0; rest &= rest - 1)
    s.list_1[slot++] = std::uint16_t(512 * b + 16 * lane + __ffs(int(rest)) - 1);
  const std::uint32_t slab = s.slab_2[b][lane / 8];
  const int at = 2 * (lane % 8);
  int to = s.before_2[4 * b + lane / 8] - s.before_2[4 * g.begin] + __popc(slab & ((1u << at) - 1));
  if ((slab >> at & 1) != 0) s.list_2[to++] = std::uint8_t(64 * b + 2 * lane);
  if ((slab >> at & 2) != 0) s.list_2[to] = std::uint8_t(64 * b + 2 * lane + 1);
}

/// Lists the children and indices of the voxels of lods 3 and 4. Eight threads per brick.
__device__ void list_upper_voxels(const LowLevels& in, const Group& g, LowShared& s) {
  const int b = int(threadIdx.x) / 8 + g.begin, v = int(threadIdx.x) % 8, x = v & 1, y = v >> 1 & 1, z = v >> 2;
  if (b >= g.end) return;
  const std::uint32_t slab_3 = s.slab_3[b][z];
  const bool there = (slab_3 >> (v & 3) & 1) != 0;
  const int slot = s.before_3[2 * b + z] - s.before_3[2 * g.begin] + __popc(slab_3 & ((1u << (v & 3)) - 1));
  s.children[at_4 + b - g.begin].at[v] = there ? std::uint16_t(slot) : Slots::none;
  if (v == 0 && in.levels > 3) s.index[at_4 + b - g.begin] = index_of(s, 3, b, 0, 0, 0, 0);
  if (!there) return;
  Slots& children = s.children[at_3 + slot];
  for (int row = 0; row < 4; ++row) {
    const std::uint32_t slab = s.slab_2[b][2 * z + row / 2];
    const int bit = 2 * x + 4 * (2 * y + row % 2);
    const int at = s.before_2[4 * b + 2 * z + row / 2] - s.before_2[4 * g.begin] + __popc(slab & ((1u << bit) - 1));
    children.at[2 * row] = (slab >> bit & 1) != 0 ? std::uint16_t(at) : Slots::none;
    children.at[2 * row + 1] = (slab >> bit & 2) != 0 ? std::uint16_t(at + int(slab >> bit & 1)) : Slots::none;
  }
  if (in.levels > 2) s.index[at_3 + slot] = index_of(s, 2, b, 1, x, y, z);
}

/// Computes the visible coverage of up to eight lod-0 voxels. Reads normals only of translucent voxels.
__device__ CoverageSums see_finest(const LowLevels& in, const Children<std::uint32_t>& children, const Tables& tables,
                                   std::uint32_t raster[3]) {
  AxisCoverage all;
#pragma unroll
  for (int c = 0; c < 8; ++c) {
    const std::uint32_t at = children.at[c];
    if (at == Children<std::uint32_t>::none) continue;
    const std::uint32_t rgba = in.fine.rgba[at];
    const bool has_normal = in.fine.normal != nullptr && !is_opaque(rgba);
    const Voxel voxel = unpack_voxel(rgba, has_normal ? in.fine.normal[at] : std::uint16_t(0));
    all.add(c, coverage_of_finest(voxel, has_normal, tables));
  }
  return see_voxels(all, raster);
}

template <bool by_view>
__device__ void filter_lod_1(const LowLevels& in, const Group& g, const Tables& tables, LowShared& s) {
  for (int i = int(threadIdx.x); i < g.n1; i += filter_threads) {
    const int voxel = s.list_1[i], b = voxel >> 9, x = voxel & 7, y = voxel >> 3 & 7, z = voxel >> 6 & 7;
    const int octant = x >> 2 | (y >> 2) << 1 | (z >> 2) << 2;
    const std::uint64_t* mask = in.fine.mask + 8 * std::size_t(s.child[b][octant]) + 2 * (z & 3);
    const auto children = children_in<std::uint32_t>(mask[0], mask[1], s.first_0[b][octant][z & 3], x & 3, y & 3);
    Weights w{};
    if (by_view) w = weights_by_view<1>(see_finest(in, children, tables, s.raster_1[i]), children);
    const FilteredVoxel v = filter_voxel<by_view, true>(
        {in.fine.rgba, in.fine.normal, nullptr, in.fine.directional_coverage}, children, w, in.filter, tables);
    in.level[0].out.put(g.first_1 + i, v);
    if (by_view) s.patch_1[i] = v.patch;
  }
}

/// Filters a voxel of lods 2 to 4. Never inlined: three copies would exceed the instruction cache, and few threads call
/// it.
template <bool by_view>
__device__ __noinline__ FilteredVoxel filter_slots(const Slots& children, VoxelArrays below, Weights w,
                                                   MipFilter filter, Tables tables) {
  return filter_voxel<by_view, false>(below, children, w, filter, tables);
}

/// Filters the voxel in `slot`. `below` holds the voxels of the next finer level. `level` is 1 … 3, that is lod 2 to 4.
template <bool by_view>
__device__ void filter_slot(const LowLevels& in, int level, int slot, const VoxelArrays& below, const Weights& w,
                            const Tables& tables, LowShared& s) {
  const FilteredVoxel v = filter_slots<by_view>(s.children[slot], below, w, in.filter, tables);
  in.level[level].out.put(s.index[slot], v);
  s.rgba[slot] = v.rgba;
  s.normal[slot] = v.normal;
  if (by_view && slot < at_4) s.patch[slot] = v.patch;
}

template <bool by_view>
__device__ void filter_lod_2(const LowLevels& in, const Group& g, const Tables& tables, LowShared& s) {
  const VoxelsOut& from = in.level[0].out;
  const VoxelArrays below{from.rgba + g.first_1, from.normal == nullptr ? nullptr : from.normal + g.first_1, s.patch_1,
                          nullptr};
  for (int i = int(threadIdx.x); i < g.n2; i += filter_threads) {
    const int voxel = s.list_2[i], b = voxel >> 6, x = voxel & 3, y = voxel >> 2 & 3, z = voxel >> 4 & 3;
    const Slots children = children_in<std::uint16_t>(s.mask[0][b][2 * z], s.mask[0][b][2 * z + 1],
                                                      s.before[0][b][2 * z] - g.first_1, x, y);
    s.children[i] = children;
    s.index[i] = index_of(s, 1, b, 2, x, y, z);
    Weights w{};
    if (by_view) {
      const ChildRasters<2, std::uint16_t> rasters{children, s.raster_1[0]};
      w = weights_by_view<2>(cover_children<2>(rasters, s.raster_2[i]), children);
    }
    filter_slot<by_view>(in, 1, i, below, w, tables, s);
  }
}

/// Filters n voxels of level 2 or 3 (lod 3 or 4) in the slots from `at` on. The next finer level begins at slot
/// at_below. Edge is the edge of the children's coverage masks in cells.
template <bool by_view, int Edge>
__device__ void filter_few(const LowLevels& in, int level, int n, int at, int at_below, const std::uint32_t* rasters,
                           std::uint32_t* raster, const Tables& tables, LowShared& s) {
  if (by_view) {
    see_columns<Edge>(s.children + at, n, rasters, raster, s.sums);
    __syncthreads();
  }
  if (const int i = int(threadIdx.x); i < n) {
    Weights w{};
    if (by_view) w = weights_by_view<Edge>(s.sums[i].total(), s.children[at + i]);
    const bool normals = in.level[level].out.normal != nullptr;
    const VoxelArrays below{s.rgba + at_below, normals ? s.normal + at_below : nullptr, s.patch + at_below, nullptr};
    filter_slot<by_view>(in, level, at + i, below, w, tables, s);
  }
  __syncthreads();
}

/// Stores n coverage masks of `words` words. Mask i is stored as mask number place(i) of `to`.
template <class Place>
__device__ void store_rasters(const std::uint32_t* from, int n, int words, const Place& place, std::uint32_t* to) {
  for (int i = int(threadIdx.x); i < n * words; i += filter_threads)
    to[std::size_t(words) * place(i / words) + i % words] = from[i];
}

__device__ void store_last_rasters(const LowLevels& in, const Group& g, const LowShared& s) {
  if (in.levels == 1)
    store_rasters(
        s.raster_1[0], g.n1, 3, [&](int i) { return g.first_1 + std::uint32_t(i); }, in.rasters);
  else if (in.levels == 2)
    store_rasters(
        s.raster_2[0], g.n2, 12, [&](int i) { return s.index[i]; }, in.rasters);
  else if (in.levels == 3)
    store_rasters(
        s.raster_3[0], g.n3, 48, [&](int i) { return s.index[at_3 + i]; }, in.rasters);
  else
    store_rasters(
        s.raster_4[0], g.end - g.begin, 48, [&](int i) { return s.index[at_4 + i]; }, in.rasters);
}

template <bool by_view>
__device__ void filter_group(const LowLevels& in, const Group& g, const Tables& tables, LowShared& s) {
  list_voxels(g, s);
  list_upper_voxels(in, g, s);
  __syncthreads();
  filter_lod_1<by_view>(in, g, tables, s);
  __syncthreads();
  if (in.levels > 1) filter_lod_2<by_view>(in, g, tables, s);
  __syncthreads();
  if (in.levels > 2) filter_few<by_view, 4>(in, 2, g.n3, at_3, 0, s.raster_2[0], s.raster_3[0], tables, s);
  if (in.levels > 3)
    filter_few<by_view, 8>(in, 3, g.end - g.begin, at_4, at_3, s.raster_3[0], s.raster_4[0], tables, s);
  if (by_view) store_last_rasters(in, g, s);
}

template <bool by_view>
__global__ void __launch_bounds__(filter_threads, blocks)
    filter_low_levels(const __grid_constant__ LowLevels in, const __grid_constant__ Tables tables) {
  __shared__ LowShared s;
  open_bricks(in, s);
  __syncthreads();
  open_children(in, s);
  __syncthreads();
  const std::uint32_t left = in.bricks - blockIdx.x * max_bricks;
  const int bricks = left < max_bricks ? int(left) : max_bricks;
  const Group all = group_of(s, 0, bricks);
  const int together = all.n1 <= max_voxels_1 && all.n2 <= max_voxels_2 ? bricks : 1;
  for (int begin = 0; begin < bricks; begin += together) {
    if (begin != 0) __syncthreads();
    filter_group<by_view>(in, group_of(s, begin, begin + together), tables, s);
  }
}

}  // namespace

void filter_low(DeviceHeap& heap, const LowLevels& levels, const Tables& tables) {
  const auto kernel = filters_by_view(levels.filter) ? filter_low_levels<true> : filter_low_levels<false>;
  kernel<<<grid_of(levels.bricks, max_bricks), filter_threads, 0, heap.stream()>>>(levels, tables);
  check_launch("filter_low_levels");
}

}  // namespace gigabake::kernels
