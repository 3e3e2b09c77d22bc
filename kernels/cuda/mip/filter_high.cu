#include "core/base/rules.h"
#include "kernels/cuda/mip/filter_high.cuh"
#include "kernels/cuda/voxelize/bits.cuh"

namespace gigabake::kernels {
namespace {

/// Number of blocks per brick. It is above 1, so that a level of few bricks occupies the device. `together` is the
/// number of voxels that a block filters at once.
constexpr std::uint32_t blocks_per_brick = 16;
template <bool by_view>
constexpr int together = by_view ? 8 : filter_threads;

template <bool by_view>
struct HighShared {
  Children<std::uint32_t> children[together<by_view>];
  ColumnSums sums[by_view ? together<by_view> : 1];  ///< unused unless by_view
  std::uint32_t child[8], first_below[8][4];         ///< [octant]: brick number, and index of the first voxel of each
                                                     ///< slab pair
  std::uint64_t mask[8];
  int before[9];  ///< voxels before each mask word
};

template <bool by_view>
__device__ void open_brick(const HighLevel& in, std::uint32_t p, HighShared<by_view>& s) {
  const int t = int(threadIdx.x);
  if (t < 32) {
    const std::uint32_t begin = in.start[p], end = p + 1 == in.bricks ? in.fine.bricks : in.start[p + 1];
    const std::uint32_t child = begin + std::uint32_t(t / 4);
    if (child < end) {
      const std::uint32_t octant = in.fine.key[child] & 7;
      std::uint32_t below = in.fine.first[child];
      for (int w = 0; w < 2 * (t % 4); ++w) below += std::uint32_t(__popcll(in.fine.mask[8 * std::size_t(child) + w]));
      s.child[octant] = child;
      s.first_below[octant][t % 4] = below;
    }
  } else if (t < 40) {
    const int w = t - 32;
    int upto = 0;
    for (int i = 0; i <= w; ++i) upto += __popcll(in.mask[8 * std::size_t(p) + i]);
    s.mask[w] = in.mask[8 * std::size_t(p) + w];
    s.before[w + 1] = upto;
    if (w == 0) s.before[0] = 0;
  }
  __syncthreads();
}

/// Returns the children of voxel i of the brick.
template <bool by_view>
__device__ Children<std::uint32_t> children_of(const HighLevel& in, const HighShared<by_view>& s, int i) {
  int w = 0;
  while (s.before[w + 1] <= i) ++w;
  const int bit = nth_bit(s.mask[w], i - s.before[w]), x = bit & 7, y = bit >> 3;
  const int octant = x >> 2 | (y >> 2) << 1 | (w >> 2) << 2;
  const std::uint64_t* mask = in.fine.mask + 8 * std::size_t(s.child[octant]) + 2 * (w & 3);
  return children_in<std::uint32_t>(mask[0], mask[1], s.first_below[octant][w & 3], x & 3, y & 3);
}

template <bool by_view>
__global__ void __launch_bounds__(filter_threads) filter_high_level(HighLevel in, Tables tables) {
  __shared__ HighShared<by_view> s;
  const std::uint32_t p = blockIdx.x / blocks_per_brick;
  const int t = int(threadIdx.x), step = together<by_view>;
  const VoxelArrays below{in.fine.rgba, in.fine.normal, in.patches_below, nullptr};
  const std::uint32_t first = in.first[p];
  const int voxels = int(in.first[p + 1] - first);
  int begin = int(blockIdx.x % blocks_per_brick) * step;
  if (begin >= voxels) return;
  open_brick(in, p, s);
  for (; begin < voxels; begin += int(blocks_per_brick) * step) {
    const int n = voxels - begin < step ? voxels - begin : step;
    if (t < n) s.children[t] = children_of(in, s, begin + t);
    __syncthreads();
    if (by_view) {
      constexpr int words = raster_words(max_raster_edge);
      see_columns<max_raster_edge>(s.children, n, in.rasters_below, in.rasters + words * std::size_t(first + begin),
                                   s.sums);
      __syncthreads();
    }
    if (t < n) {
      Weights w{};
      if (by_view) w = weights_by_view<max_raster_edge>(s.sums[t].total(), s.children[t]);
      in.out.put(first + begin + t, filter_voxel<by_view, false>(below, s.children[t], w, in.filter, tables));
    }
    __syncthreads();
  }
}

}  // namespace

void filter_high(DeviceHeap& heap, const HighLevel& level, const Tables& tables) {
  const auto kernel = filters_by_view(level.filter) ? filter_high_level<true> : filter_high_level<false>;
  kernel<<<level.bricks * blocks_per_brick, filter_threads, 0, heap.stream()>>>(level, tables);
  check_launch("filter_high_level");
}

}  // namespace gigabake::kernels
