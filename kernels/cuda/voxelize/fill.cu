#include "core/base/rules.h"
#include "kernels/cuda/voxelize/fill.cuh"
#include "kernels/cuda/voxelize/waves.cuh"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 256, heavy_blocks = 512, hard_blocks = 512;

/// Fills heavy bricks, one brick at a time per block, and groups of easy bricks, one group per block.
template <CellMaterials materials>
__global__ void __launch_bounds__(fill_threads, FillWidth<false, materials>::blocks) fill_easy_bricks(BatchView view) {
  extern __shared__ __align__(16) unsigned char raw[];
  auto& shared = *reinterpret_cast<FillShared<false, materials>*>(raw);
  if (!batch_fits(view)) return;
  // Calls fill_bricks() once for both cases: a second inlined copy would exceed the instruction cache.
  const bool is_heavy = blockIdx.x < heavy_blocks;
  const std::uint32_t group = blockIdx.x - heavy_blocks,
                      end = is_heavy ? view.counters->heavy : blockIdx.x + view.is_easy[group];
  for (std::uint32_t i = blockIdx.x; i < end; i += heavy_blocks) {
    BrickSpan span(view.begin + group * bricks_per_block, 0);
    if (is_heavy)
      span = BrickSpan(view.heavy[i]);
    else
      span.bricks = smaller<std::uint32_t>(bricks_per_block, view.end - span.first);
    fill_bricks(view, span, shared);
    __syncthreads();
  }
}

template <CellMaterials materials>
__global__ void __launch_bounds__(fill_threads) fill_hard_bricks(BatchView view) {
  extern __shared__ __align__(16) unsigned char raw[];
  auto& shared = *reinterpret_cast<FillShared<true, materials>*>(raw);
  for (std::uint32_t i = blockIdx.x; batch_fits(view) && i < view.counters->hard; i += gridDim.x) {
    __syncthreads();
    fill_bricks(view, BrickSpan(view.hard[i]), shared);
  }
}

/// Returns the number of visible voxels up to the end of the batch; 2^32-1 if the number has more than 32 bits.
__device__ std::uint32_t visible_of(const BatchView& view, const FinestArrays& level) {
  const std::uint32_t visible = level.first[view.end];
  return visible < level.first[view.begin] ? ~0u : visible;
}

/// Returns true if the batch and its visible voxels fit.
__device__ bool level_fits(const BatchView& view, const FinestArrays& level) {
  const std::uint32_t visible = visible_of(view, level);
  return batch_fits(view) && visible <= level.capacity && visible != ~0u;
}

/// Moves the voxels of a brick. One warp per brick.
__global__ void unstage(BatchView view, FinestArrays level) {
  const std::uint32_t brick = view.begin + (blockIdx.x * blockDim.x + threadIdx.x) / 32, lane = threadIdx.x & 31;
  if (brick >= view.end || !level_fits(view, level)) return;
  const std::uint32_t staged = view.marked[brick], from = view.place[brick];
  std::uint32_t to = level.first[brick];
  for (std::uint32_t step = 0; step < staged; step += 32) {
    const std::uint32_t i = step + lane, voxel = i < staged ? view.rgba[from + i] : 0;
    const unsigned who = __ballot_sync(~0u, voxel != 0);
    const std::uint32_t at = to + std::uint32_t(__popc(who & ((1u << lane) - 1)));
    if (voxel != 0) {
      level.rgba[at] = voxel;
      if (level.normal != nullptr) level.normal[at] = view.normal[from + i];
      if (level.plane != nullptr) level.plane[at] = view.plane[from + i];
    }
    to += std::uint32_t(__popc(who));
  }
}

/// Runs with one thread after all other kernels of the batch.
__global__ void finish_batch(BatchView view, FinestArrays level) {
  BatchCounters& c = *view.counters;
  if (c.is_stopped != 0) return;
  c.max_items = larger(c.max_items, c.items);
  c.max_pairs = larger(c.max_pairs, pairs_of(view));
  c.max_staged = larger(c.max_staged, items_fit(view) ? places_of(view) : 0);
  c.visible = visible_of(view, level);
  if (level_fits(view, level)) {
    c.fragments += c.batch_fragments;
    c.voxels += c.batch_voxels;
    return;
  }
  c.is_stopped = 1;
  c.next_brick = view.begin;
  c.finished_pairs = view.bricks.start[view.begin];
  c.finished_voxels = level.first[view.begin];
}

template <class Kernel>
void allow_shared(Kernel kernel, std::size_t bytes) {
  check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, int(bytes)),
             "cudaFuncSetAttribute");
}

template <CellMaterials materials>
void fill_bricks_of(const BatchView& view, cudaStream_t stream) {
  constexpr std::size_t bytes = sizeof(FillShared<false, materials>), hard_bytes = sizeof(FillShared<true, materials>);
  allow_shared(fill_easy_bricks<materials>, bytes);
  allow_shared(fill_hard_bricks<materials>, hard_bytes);
  const unsigned groups = grid_of(view.end - view.begin, bricks_per_block);
  fill_easy_bricks<materials><<<heavy_blocks + groups, fill_threads, bytes, stream>>>(view);
  check_launch("fill_easy_bricks");
  fill_hard_bricks<materials><<<hard_blocks, fill_threads, hard_bytes, stream>>>(view);
  check_launch("fill_hard_bricks");
}

}  // namespace

void launch_fill(CellMaterials materials, const BatchView& view, cudaStream_t stream) {
  switch (materials) {
    case CellMaterials::plain:
      return fill_bricks_of<CellMaterials::plain>(view, stream);
    case CellMaterials::smooth_opaque:
      return fill_bricks_of<CellMaterials::smooth_opaque>(view, stream);
    case CellMaterials::mapped_opaque:
      return fill_bricks_of<CellMaterials::mapped_opaque>(view, stream);
    case CellMaterials::opaque:
      return fill_bricks_of<CellMaterials::opaque>(view, stream);
    case CellMaterials::smooth:
      return fill_bricks_of<CellMaterials::smooth>(view, stream);
    case CellMaterials::mapped:
      return fill_bricks_of<CellMaterials::mapped>(view, stream);
    case CellMaterials::any:
      return fill_bricks_of<CellMaterials::any>(view, stream);
  }
}

void launch_unstage(const BatchView& view, const FinestArrays& level, cudaStream_t stream) {
  unstage<<<grid_of(32 * std::uint64_t(view.end - view.begin), threads), threads, 0, stream>>>(view, level);
  check_launch("unstage");
}

void launch_finish(const BatchView& view, const FinestArrays& level, cudaStream_t stream) {
  finish_batch<<<1, 1, 0, stream>>>(view, level);
  check_launch("finish_batch");
}

}  // namespace gigabake::kernels
