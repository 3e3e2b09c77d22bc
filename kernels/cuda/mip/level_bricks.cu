#include <array>
#include <cub/device/device_scan.cuh>

#include "core/octree/morton.h"
#include "kernels/body/mask.h"
#include "kernels/body/voxelize/window.h"
#include "kernels/cuda/mip/level_bricks.cuh"

namespace gigabake::kernels {
namespace {

constexpr unsigned chunk = 1024, threads = 256;

/// The levels coarser than lod 0 under construction; arrays are indexed by lod.
struct Tree {
  std::uint32_t *key[max_levels], *start[max_levels], *first[max_levels];
  std::uint64_t* mask[max_levels];
  std::uint32_t bricks[max_levels];
  Ancestors* ancestors;
  int lods;
};

/// Returns the coarsest lod at which lod-0 brick i opens a brick, or 0 if it opens none. A lod-0 brick *opens* each
/// coarser brick of which it is the first lod-0 brick. If it opens a brick, it also opens a brick at each finer lod.
__device__ int opened_levels(const std::uint32_t* key, std::uint32_t i, int lods) {
  const int maximum = lods - 1;
  if (i == 0) return maximum;
  const int opened = (31 - __clz(int(key[i] ^ key[i - 1]))) / 3;
  return opened < maximum ? opened : maximum;
}

/// Writes the number of bricks of level `lod` that the lod-0 bricks of chunk c open (opened_levels()) to
/// before[lod · chunks + c].
__global__ void __launch_bounds__(chunk) count_opened(const std::uint32_t* key, std::uint32_t bricks, int lods,
                                                      std::uint32_t chunks, std::uint32_t* before) {
  __shared__ std::uint32_t counts[max_levels];
  if (threadIdx.x < max_levels) counts[threadIdx.x] = 0;
  __syncthreads();
  const std::uint32_t i = blockIdx.x * chunk + threadIdx.x;
  const int opened = i < bricks ? opened_levels(key, i, lods) : 0;
  for (int lod = 1; lod < lods; ++lod) {
    const unsigned who = __ballot_sync(~0u, opened >= lod);
    if (who == 0) break;
    if (threadIdx.x % 32 == 0) atomicAdd(&counts[lod], unsigned(__popc(who)));
  }
  __syncthreads();
  if (threadIdx.x >= 1 && int(threadIdx.x) < lods) before[threadIdx.x * chunks + blockIdx.x] = counts[threadIdx.x];
}

/// Returns the sum over the warp's lanes up to and including `lane`.
__device__ std::uint32_t sum_upto(std::uint32_t count, unsigned lane) {
  for (unsigned d = 1; d < 32; d *= 2) {
    const std::uint32_t lower = __shfl_up_sync(~0u, count, d);
    if (lane >= d) count += lower;
  }
  return count;
}

/// Computes the exclusive prefix sums over chunks, one warp per level, and total[lod]; total[0] = 0.
__global__ void sum_chunks(std::uint32_t chunks, std::uint32_t* before, std::uint32_t* total) {
  const std::uint32_t lod = blockIdx.x + 1, lane = threadIdx.x;
  std::uint32_t* mine = before + lod * chunks;
  std::uint32_t sum = 0;
  for (std::uint32_t step = 0; step < chunks; step += 32) {
    const std::uint32_t c = step + lane, count = c < chunks ? mine[c] : 0;
    const std::uint32_t upto = sum_upto(count, lane);
    if (c < chunks) mine[c] = sum + upto - count;
    sum += __shfl_sync(~0u, upto, 31);
  }
  if (lane == 0) total[lod] = sum;
  if (lod == 1 && lane == 0) total[0] = 0;
}

/// Clears the masks of lod 2 and coarser lods. The masks of lod 1 need no clearing, because make_masks() writes all
/// their words.
__global__ void clear_masks(Tree tree) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  for (int lod = 2; lod < tree.lods; ++lod)
    if (i < 8 * tree.bricks[lod]) tree.mask[lod][i] = 0;
}

/// Sets the bit of the voxel, three levels coarser, that covers the same cube as the brick `key`.
__device__ void set_voxel(std::uint64_t* mask, std::uint32_t key) {
  const int x = gather_three_bits(key), y = gather_three_bits(key >> 1), z = gather_three_bits(key >> 2);
  atomicOr(reinterpret_cast<unsigned long long*>(mask + z), 1ull << (x + 8 * y));
}

/// Writes keys and first children of all levels and, from lod 3 on, their masks. One thread per brick of lod 0.
__global__ void __launch_bounds__(chunk) open_bricks(const std::uint32_t* key, std::uint32_t bricks,
                                                     std::uint32_t chunks, const std::uint32_t* before, Tree tree) {
  __shared__ std::uint32_t sums[max_levels][chunk / 32];
  const unsigned lane = threadIdx.x % 32, warp = threadIdx.x / 32;
  const std::uint32_t i = blockIdx.x * chunk + threadIdx.x;
  const int opened = i < bricks ? opened_levels(key, i, tree.lods) : 0;
  for (int lod = 1; lod < tree.lods; ++lod) {
    const unsigned who = __ballot_sync(~0u, opened >= lod);
    if (lane == 0) sums[lod][warp] = unsigned(__popc(who));
  }
  __syncthreads();
  if (warp >= 1 && int(warp) < tree.lods) {
    const std::uint32_t count = sums[warp][lane];
    sums[warp][lane] = before[warp * chunks + blockIdx.x] + sum_upto(count, lane) - count;
  }
  __syncthreads();
  std::uint32_t at[max_levels];  // [lod]: the brick that contains brick i
  at[0] = i;
  const std::uint32_t mine = i < bricks ? key[i] : 0;
#pragma unroll
  for (int lod = 1; lod < max_levels; ++lod) {
    if (lod >= tree.lods) break;
    const unsigned who = __ballot_sync(~0u, opened >= lod);
    at[lod] = sums[lod][warp] + unsigned(__popc(who & ((2u << lane) - 1))) - 1;
    if (opened >= lod) {
      tree.key[lod][at[lod]] = mine >> 3 * lod;
      tree.start[lod][at[lod]] = at[lod - 1];
    }
    if (lod >= 3 && i < bricks && opened >= lod - 3)
      set_voxel(tree.mask[lod] + 8 * std::size_t(at[lod]), mine >> 3 * (lod - 3));
  }
  if (opened < 1) return;
#pragma unroll
  for (int lod = 2; lod < 5; ++lod)
    if (lod < tree.lods) tree.ancestors[at[1]].brick[lod - 2] = at[lod];
}

/// Computes the masks of lods 1 and 2 from the masks of lod 0: eight threads per brick of lod 1, one mask word each.
__global__ void make_masks(LevelView fine, Tree tree) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x, p = i / 8;
  const int z = int(i % 8);
  std::uint64_t word = 0;
  const bool there = p < tree.bricks[1];
  if (there) {
    const std::uint32_t begin = tree.start[1][p], end = p + 1 == tree.bricks[1] ? fine.bricks : tree.start[1][p + 1];
    for (std::uint32_t child = begin; child < end; ++child) {
      const std::uint32_t octant = fine.key[child] & 7;
      if (octant >> 2 != std::uint32_t(z >> 2)) continue;
      const std::uint64_t* m = fine.mask + 8 * std::size_t(child) + 2 * (z & 3);
      word |= parent_slab(m[0], m[1]) << (4 * (octant & 1) + 32 * (octant >> 1 & 1));
    }
    tree.mask[1][i] = word;
  }
  const std::uint64_t above = __shfl_down_sync(~0u, word, 1, 8);
  if (!there || tree.lods < 3 || z % 2 != 0) return;
  const std::uint32_t octant = tree.key[1][p] & 7;
  std::uint64_t* to = tree.mask[2] + 8 * std::size_t(tree.ancestors[p].brick[0]) + 4 * (octant >> 2) + z / 2;
  atomicOr(reinterpret_cast<unsigned long long*>(to),
           (unsigned long long)(parent_slab(word, above) << (4 * (octant & 1) + 32 * (octant >> 1 & 1))));
}

/// The bricks of all coarser levels in one sequence, level after level.
struct AllBricks {
  std::uint32_t end[max_levels];  ///< [lod]: end of its bricks in the sequence; 0 for lod 0

  __device__ int lod_of(std::uint32_t i) const {
    int lod = 1;
    while (i >= end[lod]) ++lod;
    return lod;
  }
};

__global__ void count_voxels(Tree tree, AllBricks all, std::uint32_t bricks, std::uint32_t* count) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= bricks) return;
  const int lod = all.lod_of(i);
  const std::uint64_t* mask = tree.mask[lod] + 8 * std::size_t(i - all.end[lod - 1]);
  std::uint32_t n = 0;
#pragma unroll
  for (int w = 0; w < 8; ++w) n += std::uint32_t(__popcll(mask[w]));
  count[i] = n;
}

/// Writes the index of each brick's first voxel. `sum` holds inclusive prefix sums of voxels over all bricks. Also
/// writes `total`, the voxels per lod; it is 0 for lod 0.
__global__ void place_voxels(Tree tree, AllBricks all, std::uint32_t bricks, const std::uint32_t* sum,
                             std::uint32_t* total) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= bricks) return;
  const int lod = all.lod_of(i);
  const std::uint32_t b = i - all.end[lod - 1], before = lod == 1 ? 0 : sum[all.end[lod - 1] - 1];
  tree.first[lod][b + 1] = sum[i] - before;
  if (b == 0) tree.first[lod][0] = 0;
  if (i + 1 == all.end[lod]) total[lod] = sum[i] - before;
  if (i == 0) total[0] = 0;
}

using Counts = std::array<std::uint32_t, max_levels>;

Counts read_counts(DeviceHeap& heap, const DeviceArray<std::uint32_t>& from) {
  Counts counts{};
  heap.bring(counts.data(), from.data(), from.bytes(), "counting bricks of levels");
  return counts;
}

/// Allocates the arrays of the bricks. `count` holds the bricks per lod.
Tree make_room(DeviceHeap& heap, const Counts& count, int lods, CoarserBricks& out) {
  Tree tree{};
  tree.lods = lods;
  for (int lod = 1; lod < lods; ++lod) {
    const std::uint32_t n = count[std::size_t(lod)];
    DeviceLevel level;
    level.bricks = n;
    level.key = DeviceArray<std::uint32_t>(heap, n);
    level.mask = DeviceArray<std::uint64_t>(heap, 8 * std::size_t(n));
    level.first = DeviceArray<std::uint32_t>(heap, n + 1);
    out.starts.emplace_back(heap, n);
    tree.bricks[lod] = n;
    tree.key[lod] = level.key.data();
    tree.mask[lod] = level.mask.data();
    tree.first[lod] = level.first.data();
    tree.start[lod] = out.starts.back().data();
    out.levels.push_back(std::move(level));
  }
  out.ancestors = DeviceArray<Ancestors>(heap, count[1]);
  tree.ancestors = out.ancestors.data();
  return tree;
}

/// Computes each brick's first voxel. Returns the voxels per level.
Counts place_all_voxels(DeviceHeap& heap, const Tree& tree) {
  AllBricks all{};
  for (int lod = 1; lod < tree.lods; ++lod) all.end[lod] = all.end[lod - 1] + tree.bricks[lod];
  const std::uint32_t bricks = all.end[tree.lods - 1];
  DeviceArray<std::uint32_t> count(heap, bricks), sum(heap, bricks), total(heap, std::size_t(tree.lods));
  count_voxels<<<grid_of(bricks, threads), threads, 0, heap.stream()>>>(tree, all, bricks, count.data());
  check_launch("count_voxels");
  with_temporary(heap, [&](void* temporary, std::size_t& bytes) {
    check_cuda(cub::DeviceScan::InclusiveSum(temporary, bytes, count.data(), sum.data(), bricks, heap.stream()),
               "DeviceScan");
  });
  place_voxels<<<grid_of(bricks, threads), threads, 0, heap.stream()>>>(tree, all, bricks, sum.data(), total.data());
  check_launch("place_voxels");
  return read_counts(heap, total);
}

}  // namespace

CoarserBricks coarser_bricks(DeviceHeap& heap, const DeviceLevel& finest, int lods) {
  CoarserBricks out;
  if (lods < 2) return out;
  const std::uint32_t chunks = grid_of(finest.bricks, chunk);
  DeviceArray<std::uint32_t> before(heap, std::size_t(lods) * chunks), total(heap, std::size_t(lods));
  count_opened<<<chunks, chunk, 0, heap.stream()>>>(finest.key.data(), finest.bricks, lods, chunks, before.data());
  check_launch("count_opened");
  sum_chunks<<<unsigned(lods - 1), 32, 0, heap.stream()>>>(chunks, before.data(), total.data());
  check_launch("sum_chunks");
  const Tree tree = make_room(heap, read_counts(heap, total), lods, out);
  clear_masks<<<grid_of(8 * std::uint64_t(tree.bricks[1]), threads), threads, 0, heap.stream()>>>(tree);
  check_launch("clear_masks");
  open_bricks<<<chunks, chunk, 0, heap.stream()>>>(finest.key.data(), finest.bricks, chunks, before.data(), tree);
  check_launch("open_bricks");
  make_masks<<<grid_of(8 * std::uint64_t(tree.bricks[1]), threads), threads, 0, heap.stream()>>>(view_of(finest), tree);
  check_launch("make_masks");
  const Counts voxels = place_all_voxels(heap, tree);
  for (std::size_t l = 0; l < out.levels.size(); ++l) out.levels[l].voxels = voxels[l + 1];
  return out;
}

}  // namespace gigabake::kernels
