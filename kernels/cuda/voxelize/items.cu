#include <cub/block/block_scan.cuh>

#include "core/base/rules.h"
#include "kernels/body/voxelize/triangle_bricks.h"
#include "kernels/cuda/voxelize/items.cuh"

namespace gigabake::kernels {
namespace {

/// Returns the brick of [begin, end) that owns the pair.
__device__ std::uint32_t brick_of_pair(const std::uint32_t* start, std::uint32_t begin, std::uint32_t end,
                                       std::uint32_t pair) {
  while (end - begin > 1) {
    const std::uint32_t middle = begin + (end - begin) / 2;
    (start[middle] <= pair ? begin : end) = middle;
  }
  return begin;
}

/// Returns the same as brick_of_pair(). The whole warp must call it; it takes three dependent loads instead of fifteen.
__device__ std::uint32_t brick_of_pair_by_warp(const std::uint32_t* start, std::uint32_t begin, std::uint32_t end,
                                               std::uint32_t pair) {
  const std::uint32_t lane = threadIdx.x & 31;
  while (end - begin > 1) {
    const std::uint32_t step = (end - begin + 31) / 32, at = begin + lane * step;
    const unsigned not_beyond = __ballot_sync(~0u, at < end && start[at] <= pair);
    begin += (unsigned(__popc(not_beyond)) - 1) * step;
    end = smaller(begin + step, end);
  }
  return begin;
}

/// The eight slabs of a thread. They are in shared memory because their index is known only at run time.
struct ThreadSlabs {
  std::uint64_t* first;
  __device__ std::uint64_t& operator[](int w) const { return first[w * int(pairs_per_group)]; }
};

/// Computes the overlapped cells of the eight slabs of a pair's brick. Returns the bits `wide` and `axis` of
/// ItemView::where.
template <class I>
__device__ std::uint32_t touch(const WindowTriangle& w, const Vec3<std::int32_t>& corner, SurfaceRule rule,
                               ThreadSlabs slabs) {
  const BrickTriangle<I> t = make_brick_triangle<I>(w, corner);
  touched_voxels(t, rule, slabs);
  return std::uint32_t(sizeof(I) > 8) << 5 | std::uint32_t(t.axis) << 3;
}

__device__ std::uint32_t touch_pair(const InputView& in, SurfaceRule rule, const BricksView& bricks,
                                    std::uint32_t begin, std::uint32_t end, std::uint32_t pair, ThreadSlabs slabs) {
  const Vec3<std::int32_t> corner = brick_corner(bricks.key[brick_of_pair(bricks.start, begin, end, pair)]);
  const WindowTriangle w = window_triangle(in, bricks.triangle[pair]);
  return with_integer_for(w, [&](auto integer) { return touch<decltype(integer)>(w, corner, rule, slabs); });
}

}  // namespace

__global__ void __launch_bounds__(pairs_per_group, 3)
    find_items(InputView in, SurfaceRule rule, BricksView bricks, std::uint32_t begin, std::uint32_t end,
               ItemView items) {
  using Scan = cub::BlockScan<std::uint32_t, int(pairs_per_group)>;
  __shared__ typename Scan::TempStorage scan;
  __shared__ std::uint32_t group_first, group_bricks[2];
  __shared__ std::uint64_t all_slabs[8 * pairs_per_group];
  if (*items.is_stopped != 0) return;
  const ThreadSlabs slabs{all_slabs + threadIdx.x};
  const std::uint32_t first_pair = bricks.start[begin], pairs = bricks.start[end] - first_pair;
  for (std::uint32_t group = blockIdx.x; group * pairs_per_group < pairs; group += gridDim.x) {
    const std::uint32_t pair = group * pairs_per_group + threadIdx.x;
    std::uint32_t mine = 0, before = 0, all = 0, where = 0;
    // Two warps find the group's first and last brick; then each thread searches between them.
    if (const unsigned warp = threadIdx.x / 32; warp < 2)
      group_bricks[warp] = brick_of_pair_by_warp(
          bricks.start, begin, end,
          first_pair + smaller(group * pairs_per_group + (pairs_per_group - 1) * warp, pairs - 1));
    __syncthreads();
    if (pair < pairs) {
      where = touch_pair(in, rule, bricks, group_bricks[0], group_bricks[1] + 1, first_pair + pair, slabs) | pair << 6;
      for (int w = 0; w < 8; ++w) mine += slabs[w] != 0;
    }
    Scan(scan).ExclusiveSum(mine, before, all);
    if (threadIdx.x == 0) {
      group_first = atomicAdd(items.count, all);
      if (group * pairs_per_group < items.pairs) items.group_end[group] = group_first + all;
    }
    __syncthreads();
    std::uint32_t at = group_first + before;
    if (pair < pairs && pair < items.pairs) items.first[pair] = at;
    for (std::uint32_t w = 0; mine != 0; ++w) {
      if (slabs[int(w)] == 0) continue;
      if (at < items.capacity) {
        items.cells[at] = slabs[int(w)];
        items.where[at] = where | w;
      }
      ++at;
      --mine;
    }
    __syncthreads();  // scan and group_first are reused
  }
}

}  // namespace gigabake::kernels
