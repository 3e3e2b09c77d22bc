#include <cub/device/device_scan.cuh>
#include <cub/device/device_select.cuh>
#include <thrust/iterator/counting_iterator.h>

#include "kernels/cuda_levels.cuh"
#include "kernels/mip.h"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 256;
constexpr std::uint32_t few_parents = 4096;  ///< fewer do not fill a device with a warp each
constexpr int most_levels = 11;              ///< of a window of 8192 voxels
struct LevelView {
  const std::uint32_t *key, *first;
  const std::uint64_t* mask;
  const std::uint32_t* rgba;
  const std::uint16_t* normal;  ///< or null
  std::uint32_t bricks;
};

LevelView view_of(const DeviceLevel& l) {
  return {l.key.data(), l.first.data(), l.mask.data(), l.rgba.data(), l.normal.size() == 0 ? nullptr : l.normal.data(),
          l.bricks};
}

struct LevelCounts {
  std::uint32_t bricks[most_levels];
};

/// A brick opens a new one at every level where its key and that of the brick before it differ.
__global__ void count_ancestors(const std::uint32_t* key, std::uint32_t bricks, int lods, LevelCounts* counts) {
  __shared__ unsigned mine[most_levels];
  if (threadIdx.x < most_levels) mine[threadIdx.x] = 0;
  __syncthreads();
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < bricks)
    for (int l = 1; l < lods && (i == 0 || key[i] >> 3 * l != key[i - 1] >> 3 * l); ++l) atomicAdd(&mine[l], 1u);
  __syncthreads();
  if (threadIdx.x < most_levels && mine[threadIdx.x] != 0) atomicAdd(&counts->bricks[threadIdx.x], mine[threadIdx.x]);
}

struct StartsParent {
  const std::uint32_t* key;
  __device__ bool operator()(std::uint32_t i) const { return i == 0 || key[i] >> 3 != key[i - 1] >> 3; }
};

/// Even bits of a row pair, closed up: bit x of the result is bit 2x.
__device__ std::uint64_t close_up(std::uint64_t rows) {
  rows &= 0x0055005500550055ull;  // one row in two, one bit in two
  rows = (rows | rows >> 1) & 0x0033003300330033ull;
  rows = (rows | rows >> 2) & 0x000f000f000f000full;
  return rows;  // row y at bits 16 y
}

/// The 4×4 parent voxels that slabs 2z and 2z+1 of a child make: bit x + 8 y.
__device__ std::uint64_t parent_slab(std::uint64_t low, std::uint64_t high) {
  std::uint64_t m = low | high;
  m |= m >> 1;
  m |= m >> 8;
  m = close_up(m);
  return (m & 0xf) | (m >> 8 & 0xf00) | (m >> 16 & 0xf0000) | (m >> 24 & 0xf000000);
}

/// Eight threads a parent, a word each. `start`: parents' first children.
__global__ void make_parents(LevelView fine, const std::uint32_t* start, std::uint32_t parents, std::uint32_t* key,
                             std::uint64_t* mask, std::uint32_t* count) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x, p = i / 8;
  const bool there = p < parents;
  std::uint64_t word = 0;
  if (there) {
    const std::uint32_t end = p + 1 == parents ? fine.bricks : start[p + 1];
    const int z = int(i % 8);
    for (std::uint32_t child = start[p]; child < end; ++child) {
      const std::uint32_t octant = fine.key[child] & 7;
      if (octant >> 2 != std::uint32_t(z >> 2)) continue;
      const std::uint64_t* m = fine.mask + 8 * std::size_t(child) + 2 * (z & 3);
      word |= parent_slab(m[0], m[1]) << (4 * (octant & 1) + 32 * (octant >> 1 & 1));
    }
    mask[i] = word;
    if (z == 0) key[p] = fine.key[start[p]] >> 3;
  }
  std::uint32_t n = std::uint32_t(__popcll(word));
  for (int d = 4; d != 0; d /= 2) n += __shfl_down_sync(~0u, n, d, 8);
  if (there && i % 8 == 0) count[p] = n;
}

__device__ Voxel voxel_at(const LevelView& level, std::uint32_t i) {
  Voxel v;
  const std::uint32_t rgba = level.rgba[i];
  for (int c = 0; c < 4; ++c) v.rgba[c] = std::uint8_t(rgba >> 8 * c);
  const std::uint16_t normal = level.normal == nullptr ? 0 : level.normal[i];
  v.normal[0] = std::int8_t(normal & 255);
  v.normal[1] = std::int8_t(normal >> 8);
  return v;
}

/// The 2×2×2 voxels below one, x | y<<1 | z<<2.
struct Children {
  std::uint32_t at[8];  ///< in their level; none: there is none
  static constexpr std::uint32_t none = UINT32_MAX;
};

/// Those of a brick from (2x, 2y, 2z). before: voxels of the brick below slab 2z.
__device__ Children children_of(const LevelView& level, std::uint32_t brick, std::uint32_t before, int x, int y,
                                int z) {
  Children children;
  const std::uint64_t* mask = level.mask + 8 * std::size_t(brick);
  std::uint32_t first = level.first[brick] + before;
#pragma unroll
  for (int dz = 0; dz < 2; ++dz) {
    const std::uint64_t word = mask[2 * z + dz];
#pragma unroll
    for (int dy = 0; dy < 2; ++dy) {
      const int bit = 2 * x + 8 * (2 * y + dy);
      std::uint32_t at = first + std::uint32_t(__popcll(word & ((std::uint64_t(1) << bit) - 1)));
#pragma unroll
      for (int dx = 0; dx < 2; ++dx)
        children.at[dx | dy << 1 | dz << 2] = (word >> (bit + dx) & 1) != 0 ? at++ : Children::none;
    }
    first += std::uint32_t(__popcll(word));
  }
  return children;
}

/// What see_run() asks, of a level with rasters (kernels/facing.h), or of lod 0.
template <int Edge>
struct ChildRasters {
  const Children& children;
  const std::uint32_t* rgba;
  const std::uint8_t* rasters;

  template <int N>
  __device__ CellRun<N> cells(int child, int axis, int run) const {
    CellRun<N> out = {};
    const std::uint32_t at = children.at[child];
    if (at == Children::none) return out;
    if constexpr (N == 1)
      out.cell[0] = std::uint8_t(rgba[at] >> 24);
    else
      out = reinterpret_cast<const CellRun<N>*>(rasters +
                                                std::size_t(raster_bytes(Edge)) * at)[axis * Edge * Edge / N + run];
    return out;
  }
};

/// Where a voxel's facing and raster go.
struct ViewOut {
  std::uint8_t *facing, *raster;
};

/// Small rasters are made in registers, by one thread; 8×8 cells by a warp, a run each.
template <int Edge>
__device__ FacingSums view(const LevelView& level, const Children& children, const std::uint8_t* rasters,
                           std::uint8_t* raster) {
  const ChildRasters<Edge> from{children, level.rgba, rasters};
  if constexpr (Edge == most_raster_edge) {
    FacingSums seen;
    for (int k = int(threadIdx.x & 31); k < 12 * runs_per_column<Edge>; k += 32)
      see_run<Edge>(from, k / 16, k / 4 % 4, k % 4, raster, seen);
    for (std::uint32_t& sum : seen.covered) sum = __reduce_add_sync(~0u, sum);
    for (std::uint32_t& sum : seen.seen) sum = __reduce_add_sync(~0u, sum);
    return seen;
  } else if constexpr (Edge == 4) {
    return see_children<Edge>(from, raster);
  } else {
    constexpr int words = raster_bytes(2 * Edge) / 4;
    alignas(16) std::uint8_t cells[4 * words];
    const FacingSums seen = see_children<Edge>(from, cells);
#pragma unroll
    for (int w = 0; w < words; ++w)
      reinterpret_cast<std::uint32_t*>(raster)[w] = reinterpret_cast<const std::uint32_t*>(cells)[w];
    return seen;
  }
}

/// Edge: of the children's rasters.
template <int Edge>
__device__ Voxel filter_by_view(const LevelView& level, const Children& children, const std::uint8_t* rasters,
                                const Tables& tables, const ViewOut& out) {
  const FacingSums seen = view<Edge>(level, children, rasters, out.raster);
  std::uint8_t facing[3];
#pragma unroll
  for (int a = 0; a < 3; ++a) out.facing[a] = facing[a] = seen.facing(a, Edge);
  MipSums sums;
#pragma unroll
  for (int c = 0; c < 8; ++c)
    if (children.at[c] != Children::none) sums.add(voxel_at(level, children.at[c]), seen.weight(c, Edge), tables);
  if (sums.weight == 0) {  // too faint to be seen
#pragma unroll
    for (int c = 0; c < 8; ++c)
      if (children.at[c] != Children::none) sums.add(voxel_at(level, children.at[c]), 1, tables);
  }
  return sums.voxel(largest(facing), tables);
}

__device__ Voxel filter_by_mean(const LevelView& level, const Children& children, MipFilter filter,
                                const Tables& tables) {
  MipSums sums;
#pragma unroll
  for (int c = 0; c < 8; ++c) {
    if (children.at[c] == Children::none) continue;
    const Voxel v = voxel_at(level, children.at[c]);
    sums.add(v, v.rgba[3], tables);
  }
  return sums.voxel(mean_coverage(sums.weight, filter, tables), tables);
}

struct ParentView {
  const std::uint32_t *start, *first;
  const std::uint64_t* mask;
  std::uint32_t* rgba;
  std::uint16_t* normal;           ///< or null
  std::uint8_t *facing, *rasters;  ///< or null, without MipFilter::coverage
  std::uint32_t parents;
};

/// `warps` warps a parent: the voxels are listed by each, then filtered side by side; those whose
/// children have large rasters by a whole warp. Edge: of the rasters of `fine`, which are null at lod 0; 0: a filter
/// without views.
template <int Edge, int warps>
__global__ void __launch_bounds__(128, Edge == 0 ? 8 : 4)
    filter_parents(LevelView fine, const std::uint8_t* rasters, ParentView out, MipFilter filter, Tables tables) {
  __shared__ std::uint16_t lists[4][brick_voxels];
  __shared__ std::uint32_t children[4][8];
  __shared__ std::uint16_t before[4][32];  // [child][slab pair]: voxels of the child below
  const int lane = int(threadIdx.x & 31), warp = int(threadIdx.x / 32);
  const std::uint32_t of_grid = blockIdx.x * 4 + std::uint32_t(warp), p = of_grid / warps;
  if (p >= out.parents) return;
  const std::uint32_t begin = out.start[p], end = p + 1 == out.parents ? fine.bricks : out.start[p + 1];
  if (begin + std::uint32_t(lane / 4) < end) {
    const std::uint32_t child = begin + std::uint32_t(lane / 4), octant = fine.key[child] & 7;
    std::uint32_t below_pair = 0;
    for (int w = 0; w < 2 * (lane % 4); ++w)
      below_pair += std::uint32_t(__popcll(fine.mask[8 * std::size_t(child) + w]));
    children[warp][octant] = child;
    before[warp][4 * octant + lane % 4] = std::uint16_t(below_pair);
  }
  const std::uint64_t* mask = out.mask + 8 * std::size_t(p);
  std::uint32_t below = 0;
  for (int word = 0; word < 8; ++word) {
    const std::uint64_t m = mask[word];
    for (int half = 0; half < 2; ++half) {
      const auto bits = std::uint32_t(m >> 32 * half);
      if (bits >> lane & 1)
        lists[warp][below + __popc(bits & ((1u << lane) - 1))] = std::uint16_t(64 * word + 32 * half + lane);
      below += std::uint32_t(__popc(bits));
    }
  }
  __syncwarp();
  const std::uint32_t first = out.first[p];
  constexpr bool by_warp = Edge == most_raster_edge;
  const std::uint32_t begin_at = of_grid % warps * (by_warp ? 1 : 32) + std::uint32_t(by_warp ? 0 : lane);
  for (std::uint32_t i = begin_at; i < below; i += warps * (by_warp ? 1 : 32)) {
    const int voxel = lists[warp][i], x = voxel & 7, y = voxel >> 3 & 7, z = voxel >> 6;
    const int octant = x >> 2 | (y >> 2) << 1 | (z >> 2) << 2;
    const Children below_it =
        children_of(fine, children[warp][octant], before[warp][4 * octant + (z & 3)], x & 3, y & 3, z & 3);
    Voxel v;
    if constexpr (Edge == 0) {
      v = filter_by_mean(fine, below_it, filter, tables);
    } else {
      const std::size_t to = first + i;
      constexpr int bytes = raster_bytes(Edge < most_raster_edge ? 2 * Edge : most_raster_edge);
      v = filter_by_view<Edge>(fine, below_it, rasters, tables, {out.facing + 3 * to, out.rasters + bytes * to});
    }
    if (by_warp && lane != 0) continue;
    out.rgba[first + i] = std::uint32_t(v.rgba[0]) | std::uint32_t(v.rgba[1]) << 8 | std::uint32_t(v.rgba[2]) << 16 |
                          std::uint32_t(v.rgba[3]) << 24;
    if (out.normal != nullptr)
      out.normal[first + i] = std::uint16_t(std::uint8_t(v.normal[0]) | std::uint8_t(v.normal[1]) << 8);
  }
}

/// How many bricks each coarser level has.
LevelCounts ancestor_counts(DeviceHeap& heap, const DeviceLevel& finest, int lods) {
  DeviceArray<LevelCounts> counts(heap, 1);
  counts.clear_to_zero();
  count_ancestors<<<grid_of(finest.bricks, threads), threads, 0, heap.stream()>>>(finest.key.data(), finest.bricks,
                                                                                  lods, counts.data());
  check_launch("count_ancestors");
  LevelCounts host;
  check_cuda(cudaMemcpyAsync(&host, counts.data(), sizeof host, cudaMemcpyDeviceToHost, heap.stream()),
             "cudaMemcpyAsync (level counts)");
  check_cuda(cudaStreamSynchronize(heap.stream()), "cudaStreamSynchronize (level counts)");
  return host;
}

/// A level's bricks without their voxels yet.
struct Parents {
  DeviceLevel level;
  DeviceArray<std::uint32_t> start;
};

class LevelBuilder {
 public:
  LevelBuilder(DeviceHeap& heap, std::uint32_t most_bricks) : heap_(heap) {
    std::size_t select = 0, scan = 0;
    std::uint32_t* none = nullptr;
    check_cuda(cub::DeviceSelect::If(nullptr, select, thrust::counting_iterator<std::uint32_t>(0), none, none,
                                     most_bricks, StartsParent{none}, heap.stream()),
               "DeviceSelect");
    check_cuda(cub::DeviceScan::ExclusiveSum(nullptr, scan, none, none, most_bricks + 1, heap.stream()), "DeviceScan");
    temporary_ = TemporaryStorage(heap, std::max(select, scan));
    selected_ = DeviceArray<std::uint32_t>(heap, 1);
  }

  /// fine: its bricks; voxels are not read.
  Parents parents_of(const DeviceLevel& fine, std::uint32_t bricks) {
    Parents p;
    p.level.bricks = bricks;
    p.start = DeviceArray<std::uint32_t>(heap_, bricks);
    p.level.key = DeviceArray<std::uint32_t>(heap_, bricks);
    p.level.mask = DeviceArray<std::uint64_t>(heap_, 8 * std::size_t(bricks));
    p.level.first = DeviceArray<std::uint32_t>(heap_, bricks + 1);
    DeviceArray<std::uint32_t> count(heap_, bricks + 1);
    count.clear_to_zero();
    std::size_t bytes = temporary_.size();
    check_cuda(
        cub::DeviceSelect::If(temporary_.data(), bytes, thrust::counting_iterator<std::uint32_t>(0), p.start.data(),
                              selected_.data(), fine.bricks, StartsParent{fine.key.data()}, heap_.stream()),
        "DeviceSelect");
    make_parents<<<grid_of(8 * std::uint64_t(bricks), threads), threads, 0, heap_.stream()>>>(
        view_of(fine), p.start.data(), bricks, p.level.key.data(), p.level.mask.data(), count.data());
    check_launch("make_parents");
    bytes = temporary_.size();
    check_cuda(cub::DeviceScan::ExclusiveSum(temporary_.data(), bytes, count.data(), p.level.first.data(), bricks + 1,
                                             heap_.stream()),
               "DeviceScan");
    return p;
  }

 private:
  DeviceHeap& heap_;
  TemporaryStorage temporary_;
  DeviceArray<std::uint32_t> selected_;
};

template <int Edge>
void launch_filter(DeviceHeap& heap, const LevelView& fine, const std::uint8_t* rasters, const ParentView& out,
                   MipFilter filter, const Tables& tables) {
  constexpr int most_warps = Edge == most_raster_edge ? 16 : 4;
  const bool few = Edge == most_raster_edge || out.parents <= few_parents;
  const auto kernel = few ? filter_parents<Edge, most_warps> : filter_parents<Edge, 1>;
  const unsigned blocks = grid_of(std::uint64_t(out.parents) * (few ? most_warps : 1), 4);
  kernel<<<blocks, 128, 0, heap.stream()>>>(fine, rasters, out, filter, tables);
  check_launch("filter_parents");
}

/// lod: of the parents.
void launch_filter(DeviceHeap& heap, const LevelView& fine, const std::uint8_t* rasters, const ParentView& out, int lod,
                   MipFilter filter, const Tables& tables) {
  if (filter != MipFilter::coverage) return launch_filter<0>(heap, fine, nullptr, out, filter, tables);
  if (lod == 1) return launch_filter<1>(heap, fine, nullptr, out, filter, tables);
  if (lod == 2) return launch_filter<2>(heap, fine, rasters, out, filter, tables);
  if (lod == 3) return launch_filter<4>(heap, fine, rasters, out, filter, tables);
  launch_filter<8>(heap, fine, rasters, out, filter, tables);
}

void read_voxel_counts(DeviceHeap& heap, std::vector<Parents>& levels) {
  for (Parents& p : levels)
    check_cuda(cudaMemcpyAsync(&p.level.voxels, p.level.first.data() + p.level.bricks, sizeof p.level.voxels,
                               cudaMemcpyDeviceToHost, heap.stream()),
               "cudaMemcpyAsync (voxel counts)");
  check_cuda(cudaStreamSynchronize(heap.stream()), "cudaStreamSynchronize (levels)");
}

}  // namespace

LevelsAbove coarser_levels(DeviceHeap& heap, const Tables& tables, const DeviceLevel& finest, int lods,
                           MipFilter filter, bool normals) {
  std::vector<Parents> built;
  const LevelCounts counts = ancestor_counts(heap, finest, lods);
  LevelBuilder builder(heap, finest.bricks);
  for (int l = 1; l < lods; ++l)
    built.push_back(builder.parents_of(l == 1 ? finest : built.back().level, counts.bricks[l]));
  read_voxel_counts(heap, built);
  LevelsAbove above;
  for (Parents& p : built) {
    const int lod = int(above.levels.size()) + 1;
    DeviceLevel& level = p.level;
    level.rgba = DeviceArray<std::uint32_t>(heap, level.voxels);
    if (normals) level.normal = DeviceArray<std::uint16_t>(heap, level.voxels);
    DeviceArray<std::uint8_t> rasters;
    if (filter == MipFilter::coverage) {
      level.facing = DeviceArray<std::uint8_t>(heap, 3 * std::size_t(level.voxels));
      const auto bytes = std::size_t(raster_bytes(raster_edge(lod)));
      rasters = DeviceArray<std::uint8_t>(heap, bytes * level.voxels);
    }
    const ParentView out{p.start.data(),      level.first.data(),  level.mask.data(), level.rgba.data(),
                         level.normal.data(), level.facing.data(), rasters.data(),    level.bricks};
    const LevelView fine = view_of(above.levels.empty() ? finest : above.levels.back());
    launch_filter(heap, fine, above.rasters.data(), out, lod, filter, tables);
    above.levels.push_back(std::move(level));
    above.rasters = std::move(rasters);
  }
  return above;
}

}  // namespace gigabake::kernels
