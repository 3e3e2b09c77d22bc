#include <cub/block/block_scan.cuh>

#include "kernels/cuda/pairs.cuh"
#include "lattice/brick.h"

namespace gigabake::kernels {
namespace {

constexpr int most_direct_bricks = 8;

/// A vertex as 64-bit window sub-voxels, for triangles that reach beyond 32 bits.
struct FarVertex {
  std::int64_t v[3];
};

__device__ FarVertex far_vertex(const DevicePart& part, const WindowView& window, std::uint32_t vertex) {
  LatticePoint p;
  snap(window.frame, part.scene_from_local, part.position + 3 * std::size_t(vertex), p);
  FarVertex out;
  for (int c = 0; c < 3; ++c) out.v[c] = p.v[c] - window.min[c] * subvoxels;
  return out;
}

template <class Vertex>
__device__ bool meets_window(const Vertex p[3], std::int64_t window_subvoxels) {
  for (int c = 0; c < 3; ++c) {
    const std::int64_t a = p[0].v[c], b = p[1].v[c], d = p[2].v[c];
    if (smaller(smaller(a, b), d) > window_subvoxels || larger(larger(a, b), d) < 0) return false;
  }
  return true;
}

/// Wide: a type that holds the product of two differences.
template <class Wide, class Vertex>
__device__ bool has_area(const Vertex p[3]) {
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Wide bi = Wide(p[1].v[i]) - p[0].v[i], bj = Wide(p[1].v[j]) - p[0].v[j];
    const Wide ci = Wide(p[2].v[i]) - p[0].v[i], cj = Wide(p[2].v[j]) - p[0].v[j];
    if (bi * cj != bj * ci) return true;
  }
  return false;
}

enum class Fate : std::uint8_t { none, kept, non_finite, zero_area, oversized };

__device__ Fate fate_of_far(const DevicePart& part, const WindowView& window, const std::uint32_t v[3]) {
  FarVertex p[3];
  for (int i = 0; i < 3; ++i) p[i] = far_vertex(part, window, v[i]);
  if (!meets_window(p, window.subvoxels)) return Fate::none;
  return has_area<__int128>(p) ? Fate::oversized : Fate::zero_area;
}

__device__ Fate fate_of(const InputView& in, const DevicePart& part, const WindowView& window, const std::uint32_t v[3],
                        WindowTriangle& t) {
  SnappedVertex p[3];
  bool is_far = false;
  for (int i = 0; i < 3; ++i) {
    p[i] = snapped_vertex(in, part, v[i]);
    if (p[i].v[0] == not_finite) return Fate::non_finite;
    is_far |= p[i].v[0] == out_of_reach;
    for (int c = 0; c < 3; ++c) t.p[i][c] = p[i].v[c];
  }
  if (is_far) return fate_of_far(part, window, v);
  if (!meets_window(p, window.subvoxels)) return Fate::none;
  return has_area<std::int64_t>(p) ? Fate::kept : Fate::zero_area;
}

__device__ bool has_bad_uv(const DevicePart& part, const std::uint32_t v[3]) {
  float uv[6];
  for (int i = 0; i < 6; ++i) uv[i] = part.uv[2 * std::size_t(v[i / 2]) + i % 2];
  return !usable_uv(uv);
}

/// Counts of a block, so that a counter in device memory is asked once a block: all its atomics stand in one line.
struct BlockCounts {
  unsigned kept, non_finite, zero_area, oversized, bad_uv;
};

__device__ void count(unsigned* counter, bool mine) {
  const unsigned who = __ballot_sync(~0u, mine);
  if ((threadIdx.x & 31) == 0 && who != 0) atomicAdd(counter, unsigned(__popc(who)));
}

__device__ void add_count(unsigned long long* total, unsigned block) {
  if (block != 0) atomicAdd(total, (unsigned long long)block);
}

__device__ std::int64_t brick_count(const BrickBox& box) {
  return (std::int64_t(box.last[0]) - box.first[0] + 1) * (box.last[1] - box.first[1] + 1) *
         (box.last[2] - box.first[2] + 1);
}

/// The keys of the box's bricks that are in the range.
template <class Visit>
__device__ void visit_keys(const BrickBox& box, KeyRange range, const Visit& visit) {
  for (std::int32_t z = box.first[2]; z <= box.last[2]; ++z)
    for (std::int32_t y = box.first[1]; y <= box.last[1]; ++y)
      for (std::int32_t x = box.first[0]; x <= box.last[0]; ++x) {
        const auto key = std::uint32_t(morton(std::uint32_t(x), std::uint32_t(y), std::uint32_t(z)));
        if (key >= range.first && key < range.end) visit(key);
      }
}

}  // namespace

__global__ void snap_kernel(InputView in, WindowView window, SnappedVertex* out) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= in.vertex_count) return;
  const DevicePart& part = in.parts[part_of<&DevicePart::first_vertex>(in, i)];
  out[i] = snap_vertex(window, part, i - part.first_vertex);
}

__global__ void __launch_bounds__(pair_threads) pair_kernel(InputView in, WindowView window, PairSink sink) {
  using Scan = cub::BlockScan<std::uint32_t, pair_threads>;
  __shared__ typename Scan::TempStorage scan;
  __shared__ BlockCounts counts;
  __shared__ unsigned long long first_pair;
  if (threadIdx.x == 0) counts = {};
  __syncthreads();
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  Fate fate = Fate::none;
  BrickBox box;
  bool bad_uv = false, is_large = false;
  std::uint32_t pairs = 0;
  if (i < in.triangle_count) {
    const DevicePart& part = in.parts[part_of<&DevicePart::first_triangle>(in, i)];
    std::uint32_t v[3];
    vertices_of(part, i - part.first_triangle, v);
    WindowTriangle t;
    fate = fate_of(in, part, window, v, t);
    bad_uv = fate == Fate::kept && part.textured && has_bad_uv(part, v);
    if (fate == Fate::kept && brick_box(t, window.rule, window.bricks, box)) {
      is_large = brick_count(box) > most_direct_bricks;
      if (!is_large) visit_keys(box, sink.range, [&](std::uint32_t) { ++pairs; });
    }
  }
  count(&counts.kept, fate == Fate::kept);
  count(&counts.non_finite, fate == Fate::non_finite);
  count(&counts.zero_area, fate == Fate::zero_area);
  count(&counts.oversized, fate == Fate::oversized);
  count(&counts.bad_uv, bad_uv);
  std::uint32_t before = 0, all = 0;
  Scan(scan).ExclusiveSum(pairs, before, all);
  if (threadIdx.x == 0) first_pair = all == 0 ? 0 : atomicAdd(&sink.counters->pairs, (unsigned long long)all);
  __syncthreads();
  if (threadIdx.x == 32) {
    add_count(&sink.counters->triangles, counts.kept);
    add_count(&sink.counters->non_finite, counts.non_finite);
    add_count(&sink.counters->zero_area, counts.zero_area);
    add_count(&sink.counters->oversized, counts.oversized);
    add_count(&sink.counters->bad_uv, counts.bad_uv);
  }
  std::uint64_t at = first_pair + before;
  if (pairs != 0) visit_keys(box, sink.range, [&](std::uint32_t key) { push_pair(sink, at++, key, i); });
  if (is_large) push_item(sink, 0, {i, 0});
}

__global__ void descend_kernel(InputView in, WindowView window, PairSink sink, int from, int level) {
  const std::uint64_t items = smaller<std::uint64_t>(sink.counters->items[from], sink.item_capacity);
  const std::uint64_t stride = std::uint64_t(gridDim.x) * blockDim.x;
  for (std::uint64_t i = blockIdx.x * std::uint64_t(blockDim.x) + threadIdx.x; i < 8 * items; i += stride) {
    const LargeItem item = sink.items[from][i / 8];
    const std::uint32_t key = item.node << 3 | std::uint32_t(i % 8);
    const BrickCoordinate child = demorton(key);
    const std::int32_t node[3] = {std::int32_t(child.x), std::int32_t(child.y), std::int32_t(child.z)};
    const int below = level - 1;
    if (key << 3 * below >= sink.range.end || (key + 1) << 3 * below <= sink.range.first) continue;
    const WindowTriangle t = window_triangle(in, item.triangle);
    BrickBox box;
    bool meets = brick_box(t, window.rule, window.bricks, box);
    std::int64_t corner[3];
    const std::int64_t edge = std::int64_t(1) << (brick_subvoxel_bits + below);
    for (int c = 0; c < 3; ++c) {
      meets = meets && (node[c] << below) <= box.last[c] && ((node[c] + 1) << below) > box.first[c];
      corner[c] = node[c] * edge;
    }
    meets = meets && (is_narrow(t) ? meets_cube<std::int64_t>(t, corner, edge) : meets_cube<__int128>(t, corner, edge));
    if (!meets) continue;
    if (below == 0)
      push_pair(sink, atomicAdd(&sink.counters->pairs, 1ull), key, item.triangle);
    else
      push_item(sink, 1 - from, {item.triangle, key});
  }
}

}  // namespace gigabake::kernels
