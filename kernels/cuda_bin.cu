#include <algorithm>
#include <bit>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_select.cuh>
#include <limits>
#include <stdexcept>
#include <thrust/iterator/counting_iterator.h>

#include "kernels/cuda_bin.cuh"
#include "kernels/cuda_pairs.cuh"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 256, descend_blocks = 1024;

/// Pairs as they come, and the counters after all kernels ran.
struct RawPairs {
  DeviceArray<std::uint32_t> key, triangle;
  PairCounters counted{};
};

PairCounters read(DeviceHeap& heap, const DeviceArray<PairCounters>& counters) {
  PairCounters host;
  check_cuda(cudaMemcpyAsync(&host, counters.data(), sizeof host, cudaMemcpyDeviceToHost, heap.stream()),
             "cudaMemcpyAsync (pair counters)");
  check_cuda(cudaStreamSynchronize(heap.stream()), "cudaStreamSynchronize (pairs)");
  return host;
}

/// From the root to the bricks, all large triangles side by side. Returns the longest queue.
std::uint64_t descend_large(DeviceHeap& heap, const InputView& input, const WindowView& window, const PairSink& sink,
                            const DeviceArray<PairCounters>& counters) {
  std::uint64_t longest = 0;
  int from = 0;
  for (int level = window.levels; level > 0; --level, from = 1 - from) {
    check_cuda(cudaMemsetAsync(&sink.counters->items[1 - from], 0, sizeof sink.counters->items[0], heap.stream()),
               "cudaMemsetAsync");
    descend_kernel<<<descend_blocks, threads, 0, heap.stream()>>>(input, window, sink, from, level);
    check_launch("descend_kernel");
    longest = std::max<std::uint64_t>(longest, read(heap, counters).items[1 - from]);
  }
  return longest;
}

/// A window of one brick has no tree to descend: its large triangles are pairs of their own.
RawPairs find_pairs(DeviceHeap& heap, const InputView& input, const WindowView& window, BinCapacity& capacity) {
  for (;;) {
    RawPairs raw{DeviceArray<std::uint32_t>(heap, capacity.pairs), DeviceArray<std::uint32_t>(heap, capacity.pairs)};
    DeviceArray<LargeItem> items(heap, 2 * capacity.nodes);
    DeviceArray<PairCounters> counters(heap, 1);
    counters.clear_to_zero();
    const PairSink sink{raw.key.data(), raw.triangle.data(),
                        raw.key.size(), {items.data(), items.data() + capacity.nodes},
                        capacity.nodes, counters.data()};
    pair_kernel<<<grid_of(input.triangle_count, pair_threads), pair_threads, 0, heap.stream()>>>(input, window, sink);
    check_launch("pair_kernel");
    raw.counted = read(heap, counters);
    std::uint64_t nodes = raw.counted.items[0];
    if (nodes != 0 && nodes <= capacity.nodes) {
      nodes = std::max(nodes, descend_large(heap, input, window, sink, counters));
      raw.counted = read(heap, counters);
    }
    const bool fits = raw.counted.pairs <= capacity.pairs && nodes <= capacity.nodes;
    if (raw.counted.pairs > std::numeric_limits<std::uint32_t>::max())
      throw std::length_error("a cell of more than 2^32-1 triangle-brick pairs; use a smaller --cell-voxels");
    if (fits) return raw;
    capacity.pairs = std::max<std::uint64_t>(capacity.pairs, raw.counted.pairs + raw.counted.pairs / 16);
    capacity.nodes = std::max(capacity.nodes, nodes + nodes / 16);
  }
}

struct StartsBrick {
  const std::uint32_t* key;
  __device__ bool operator()(std::uint32_t i) const { return i == 0 || key[i] != key[i - 1]; }
};

__global__ void gather_keys(const std::uint32_t* sorted, std::uint32_t* start, std::uint32_t bricks,
                            std::uint32_t pairs, std::uint32_t* key) {
  const std::uint32_t b = blockIdx.x * blockDim.x + threadIdx.x;
  if (b < bricks) key[b] = sorted[start[b]];
  if (b == bricks) start[b] = pairs;
}

}  // namespace

WindowView window_view(const CellParameters& p) {
  WindowView w;
  w.frame = p.frame;
  for (int c = 0; c < 3; ++c) w.min[c] = p.window_min[c];
  w.subvoxels = std::int64_t(p.window_voxels) * subvoxels;
  w.bricks = std::int32_t(p.window_voxels / brick_edge);
  w.levels = std::bit_width(std::uint32_t(w.bricks)) - 1;
  w.rule = p.surface;
  return w;
}

DeviceArray<SnappedVertex> snap_vertices(DeviceHeap& heap, const InputView& input, const WindowView& window) {
  DeviceArray<SnappedVertex> out(heap, input.vertex_count);
  snap_kernel<<<grid_of(input.vertex_count, threads), threads, 0, heap.stream()>>>(input, window, out.data());
  check_launch("snap_kernel");
  return out;
}

BrickLists bin_triangles(DeviceHeap& heap, const InputView& input, const WindowView& window, BinCapacity& capacity,
                         CellStats& stats) {
  RawPairs raw = find_pairs(heap, input, window, capacity);
  const auto pairs = std::uint32_t(raw.counted.pairs);
  stats.triangles += raw.counted.triangles;
  stats.non_finite += raw.counted.non_finite;
  stats.zero_area += raw.counted.zero_area;
  stats.oversized += raw.counted.oversized;
  stats.bad_uv += raw.counted.bad_uv;
  stats.pairs += pairs;
  BrickLists lists;
  if (pairs == 0) return lists;
  DeviceArray<std::uint32_t> other_key(heap, pairs), other_triangle(heap, pairs), bricks(heap, 1);
  cub::DoubleBuffer<std::uint32_t> key(raw.key.data(), other_key.data());
  cub::DoubleBuffer<std::uint32_t> triangle(raw.triangle.data(), other_triangle.data());
  const int key_bits = std::max(1, 3 * window.levels);
  const thrust::counting_iterator<std::uint32_t> counting(0);
  std::size_t sort_bytes = 0, select_bytes = 0;
  check_cuda(cub::DeviceRadixSort::SortPairs(nullptr, sort_bytes, key, triangle, pairs, 0, key_bits, heap.stream()),
             "DeviceRadixSort");
  check_cuda(cub::DeviceSelect::If(nullptr, select_bytes, counting, other_key.data(), bricks.data(), pairs,
                                   StartsBrick{raw.key.data()}, heap.stream()),
             "DeviceSelect");
  DeviceArray<std::uint8_t> temporary(heap, std::max(sort_bytes, select_bytes));
  check_cuda(
      cub::DeviceRadixSort::SortPairs(temporary.data(), sort_bytes, key, triangle, pairs, 0, key_bits, heap.stream()),
      "DeviceRadixSort");
  // The sort's other key buffer takes the starts until their number is known.
  check_cuda(cub::DeviceSelect::If(temporary.data(), select_bytes, counting, key.Alternate(), bricks.data(), pairs,
                                   StartsBrick{key.Current()}, heap.stream()),
             "DeviceSelect");
  check_cuda(cudaMemcpyAsync(&lists.bricks, bricks.data(), sizeof lists.bricks, cudaMemcpyDeviceToHost, heap.stream()),
             "cudaMemcpyAsync (bricks)");
  check_cuda(cudaStreamSynchronize(heap.stream()), "cudaStreamSynchronize (bricks)");
  lists.key = DeviceArray<std::uint32_t>(heap, lists.bricks);
  lists.start = DeviceArray<std::uint32_t>(heap, lists.bricks + 1);
  check_cuda(cudaMemcpyAsync(lists.start.data(), key.Alternate(), lists.bricks * sizeof(std::uint32_t),
                             cudaMemcpyDeviceToDevice, heap.stream()),
             "cudaMemcpyAsync (starts)");
  gather_keys<<<grid_of(lists.bricks + 1, threads), threads, 0, heap.stream()>>>(key.Current(), lists.start.data(),
                                                                                 lists.bricks, pairs, lists.key.data());
  check_launch("gather_keys");
  lists.triangle = std::move(triangle.Current() == raw.triangle.data() ? raw.triangle : other_triangle);
  return lists;
}

}  // namespace gigabake::kernels
