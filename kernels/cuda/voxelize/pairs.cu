#include <cub/block/block_scan.cuh>

#include "core/octree/morton.h"
#include "kernels/cuda/voxelize/pairs.cuh"

namespace gigabake::kernels {
namespace {

__device__ void count(unsigned* counter, bool mine) {
  const unsigned who = __ballot_sync(~0u, mine);
  if ((threadIdx.x & 31) == 0 && who != 0) atomicAdd(counter, unsigned(__popc(who)));
}

__device__ void add_count(unsigned long long* total, unsigned block) {
  if (block != 0) atomicAdd(total, (unsigned long long)block);
}

/// Adds a block's counts to the totals. A block executes one atomic per counter, because all counters share one cache
/// line.
__device__ void add_counts(const TriangleCounts<unsigned>& block, TriangleCounts<unsigned long long>& total) {
#pragma unroll
  for (int f = 0; f < triangle_classes; ++f) add_count(&total.triangle_class[f], block.triangle_class[f]);
  add_count(&total.bad_uv, block.bad_uv);
}

/// Calls visit(key) for each brick of the box whose key is in the range.
template <class Visit>
__device__ void visit_keys(const BrickBox& box, KeyRange range, const Visit& visit) {
  for_each_key(box, [&](std::uint64_t morton_key) {
    const auto key = std::uint32_t(morton_key);
    if (key >= range.first && key < range.end) visit(key);
  });
}

}  // namespace

__global__ void snap_kernel(InputView in, CellWindow window, SnappedVertex* out) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= in.vertex_count) return;
  const DevicePart& part = in.parts[part_of<&DevicePart::first_vertex>(in, i)];
  out[i] = snap_vertex(window, part, i - part.first_vertex);
}

__global__ void __launch_bounds__(pair_threads) pair_kernel(InputView in, CellWindow window, PairSink sink) {
  using Scan = cub::BlockScan<std::uint32_t, pair_threads>;
  __shared__ typename Scan::TempStorage scan;
  __shared__ TriangleCounts<unsigned> counts;
  __shared__ unsigned long long first_pair;
  if (threadIdx.x == 0) counts = {};
  __syncthreads();
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  TriangleClass triangle_class = TriangleClass::elsewhere;
  BrickBox box;
  bool bad_uv = false, is_large = false;
  std::uint32_t pairs = 0;
  if (i < in.triangle_count) {
    const DevicePart& part = in.parts[part_of<&DevicePart::first_triangle>(in, i)];
    std::uint32_t v[3];
    triangle_vertices(part, i - part.first_triangle, v);
    WindowTriangle t;
    for (int k = 0; k < 3; ++k) t.p[k] = snapped_vertex(in, part, v[k]);
    triangle_class = classify_triangle(window, part, v, t.p);
    bad_uv = has_bad_uv(triangle_class, part, v);
    if (triangle_class == TriangleClass::kept && brick_box(t, window.rule, window.bricks, box)) {
      is_large = brick_count(box) > max_direct_bricks;
      if (!is_large) visit_keys(box, sink.range, [&](std::uint32_t) { ++pairs; });
    }
  }
#pragma unroll
  for (int f = int(TriangleClass::kept); f < triangle_classes; ++f)
    count(&counts.triangle_class[f], triangle_class == TriangleClass(f));
  count(&counts.bad_uv, bad_uv);
  std::uint32_t before = 0, all = 0;
  Scan(scan).ExclusiveSum(pairs, before, all);
  if (threadIdx.x == 0) first_pair = all == 0 ? 0 : atomicAdd(&sink.counters->pairs, (unsigned long long)all);
  __syncthreads();
  if (threadIdx.x == 32) add_counts(counts, sink.counters->triangles);
  std::uint64_t at = first_pair + before;
  if (pairs != 0) visit_keys(box, sink.range, [&](std::uint32_t key) { push_pair(sink, at++, key, i); });
  if (is_large) push_item(sink, 0, {i, 0});
}

__global__ void descend_kernel(InputView in, CellWindow window, PairSink sink, int from, int level) {
  const std::uint64_t items = smaller<std::uint64_t>(sink.counters->items[from], sink.item_capacity);
  const std::uint64_t stride = std::uint64_t(gridDim.x) * blockDim.x;
  for (std::uint64_t i = blockIdx.x * std::uint64_t(blockDim.x) + threadIdx.x; i < 8 * items; i += stride) {
    const LargeItem item = sink.items[from][i / 8];
    const std::uint32_t key = item.node << 3 | std::uint32_t(i % 8);
    const auto node = static_cast<Vec3<std::int32_t>>(demorton(key));
    const int below = level - 1;
    if (key << 3 * below >= sink.range.end || (key + 1) << 3 * below <= sink.range.first) continue;
    const WindowTriangle t = window_triangle(in, item.triangle);
    BrickBox box;
    const bool meets =
        brick_box(t, window.rule, window.bricks, box) && may_touch_node(t, box, is_narrow(t), node, below);
    if (!meets) continue;
    if (below == 0)
      push_pair(sink, atomicAdd(&sink.counters->pairs, 1ull), key, item.triangle);
    else
      push_item(sink, 1 - from, {item.triangle, key});
  }
}

}  // namespace gigabake::kernels
