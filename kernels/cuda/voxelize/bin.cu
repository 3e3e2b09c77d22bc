#include <algorithm>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>
#include <limits>

#include "kernels/cuda/voxelize/bin.cuh"
#include "kernels/cuda/voxelize/pairs.cuh"
#include "kernels/cuda/voxelize/select.cuh"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 256, descend_blocks = 1024;

/// (triangle, brick) pairs in the order of their discovery, and the counters after all kernels have run.
struct RawPairs {
  DeviceArray<std::uint32_t> key, triangle;
  PairCounters counted{};
};

PairCounters read(DeviceHeap& heap, const DeviceArray<PairCounters>& counters) {
  PairCounters host;
  heap.bring(&host, counters.data(), sizeof host, "counting pairs");
  return host;
}

/// Finds the bricks of all large triangles. The search descends from the root to the bricks, all triangles in parallel.
/// Returns the max length of a queue.
std::uint64_t descend_large(DeviceHeap& heap, const InputView& input, const CellWindow& window, const PairSink& sink,
                            const DeviceArray<PairCounters>& counters) {
  std::uint64_t maximum = 0;
  int from = 0;
  for (int level = window.levels; level > 0; --level, from = 1 - from) {
    check_cuda(cudaMemsetAsync(&sink.counters->items[1 - from], 0, sizeof sink.counters->items[0], heap.stream()),
               "cudaMemsetAsync");
    descend_kernel<<<descend_blocks, threads, 0, heap.stream()>>>(input, window, sink, from, level);
    check_launch("descend_kernel");
    maximum = std::max<std::uint64_t>(maximum, read(heap, counters).items[1 - from]);
  }
  return maximum;
}

/// Output buffers of one attempt. They hold no pairs if only the pairs per unit are counted.
struct PairBuffers {
  RawPairs raw;
  DeviceArray<LargeItem> items;
  DeviceArray<PairCounters> counters;

  PairBuffers(DeviceHeap& heap, const BinCapacity& capacity)
      : raw{DeviceArray<std::uint32_t>(heap, capacity.pairs), DeviceArray<std::uint32_t>(heap, capacity.pairs)},
        items(heap, 2 * capacity.nodes),
        counters(heap, 1) {
    counters.clear_to_zero();
  }
  PairSink sink(KeyRange range) const {
    const std::size_t half = items.size() / 2;
    return {range,
            raw.key.data(),
            raw.triangle.data(),
            raw.key.size(),
            nullptr,
            nullptr,
            0,
            {items.data(), items.data() + half},
            half,
            counters.data()};
  }
};

/// Counts all pairs in `pair_buffers.raw.counted` and writes the pairs that fit. Returns the required queue capacity. A
/// window of one brick has no large triangles, so its pairs need no descent.
std::uint64_t find_pairs(DeviceHeap& heap, const InputView& input, const CellWindow& window, const PairSink& sink,
                         PairBuffers& pair_buffers) {
  pair_kernel<<<grid_of(input.triangle_count, pair_threads), pair_threads, 0, heap.stream()>>>(input, window, sink);
  check_launch("pair_kernel");
  pair_buffers.raw.counted = read(heap, pair_buffers.counters);
  std::uint64_t nodes = pair_buffers.raw.counted.items[0];
  if (nodes == 0 || nodes > sink.item_capacity) return nodes;
  nodes = std::max(nodes, descend_large(heap, input, window, sink, pair_buffers.counters));
  pair_buffers.raw.counted = read(heap, pair_buffers.counters);
  return nodes;
}

std::uint32_t counted_pairs(const PairCounters& counted) {
  if (counted.pairs > std::numeric_limits<std::uint32_t>::max())
    throw DeviceFull("more than 2^32-1 triangle-brick pairs");
  return std::uint32_t(counted.pairs);
}

RawPairs pairs_in(DeviceHeap& heap, const InputView& input, const CellWindow& window, KeyRange range,
                  BinCapacity& capacity) {
  for (;;) {
    PairBuffers pair_buffers(heap, capacity);
    const std::uint64_t nodes = find_pairs(heap, input, window, pair_buffers.sink(range), pair_buffers),
                        pairs = pair_buffers.raw.counted.pairs;
    counted_pairs(pair_buffers.raw.counted);
    if (pairs <= capacity.pairs && nodes <= capacity.nodes) return std::move(pair_buffers.raw);
    capacity.pairs = std::max(capacity.pairs, pairs + pairs / 16);
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

/// Max bricks of a range for which pairs are counted per brick; pairs of larger ranges are sorted.
constexpr std::uint32_t max_counted_bricks = 1 << 21;

/// Counts the pairs of each brick in `brick`. If `triangle` is given, writes the triangles to `triangle` instead, at
/// the places in `brick`.
PairCounters pairs_by_brick(DeviceHeap& heap, const InputView& input, const CellWindow& window, KeyRange range,
                            DeviceArray<std::uint32_t>& brick, DeviceArray<std::uint32_t>* triangle,
                            BinCapacity& capacity) {
  for (;;) {
    PairBuffers pair_buffers(heap, {0, capacity.nodes});
    PairSink sink = pair_buffers.sink(range);
    sink.brick = brick.data();
    if (triangle == nullptr) {
      brick.clear_to_zero();
    } else {
      sink.triangle = triangle->data();
      sink.capacity = triangle->size();
    }
    const std::uint64_t nodes = find_pairs(heap, input, window, sink, pair_buffers);
    if (nodes <= capacity.nodes) return pair_buffers.raw.counted;
    capacity.nodes = nodes + nodes / 16;
  }
}

struct HasPairs {
  const std::uint32_t* start;
  __device__ bool operator()(std::uint32_t i) const { return start[i] != start[i + 1]; }
};

__global__ void gather_starts(const std::uint32_t* start_of, const std::uint32_t* picked, std::uint32_t bricks,
                              std::uint32_t pairs, std::uint32_t first_key, std::uint32_t* key, std::uint32_t* start) {
  const std::uint32_t b = blockIdx.x * blockDim.x + threadIdx.x;
  if (b == bricks) start[b] = pairs;
  if (b >= bricks) return;
  key[b] = first_key + picked[b];
  start[b] = start_of[picked[b]];
}

/// Returns keys and starts of the bricks that have pairs. `start_of` has one entry per brick of the range, and the end.
BrickLists bricks_with_pairs(DeviceHeap& heap, const DeviceArray<std::uint32_t>& start_of, KeyRange range,
                             std::uint32_t pairs) {
  const std::uint32_t n = range.end - range.first;
  BrickLists lists;
  const DeviceArray<std::uint32_t> picked(heap, n);
  lists.bricks = select_indices(heap, n, HasPairs{start_of.data()}, picked.data());
  lists.key = DeviceArray<std::uint32_t>(heap, lists.bricks);
  lists.start = DeviceArray<std::uint32_t>(heap, lists.bricks + 1);
  gather_starts<<<grid_of(lists.bricks + 1, threads), threads, 0, heap.stream()>>>(
      start_of.data(), picked.data(), lists.bricks, pairs, range.first, lists.key.data(), lists.start.data());
  check_launch("gather_starts");
  return lists;
}

/// Returns the triangles of each brick by a counting sort of the (triangle, brick) pairs. It takes four bytes per pair;
/// a radix sort takes sixteen.
BrickLists counted_lists(DeviceHeap& heap, const InputView& input, const CellWindow& window, KeyRange range,
                         BinCapacity& capacity, CellStats& stats) {
  DeviceArray<std::uint32_t> brick(heap, std::size_t(range.end - range.first) + 1);
  const PairCounters counted = pairs_by_brick(heap, input, window, range, brick, nullptr, capacity);
  const std::uint32_t pairs = counted_pairs(counted);
  add_to(stats, counted.triangles);
  stats.pairs += pairs;
  if (pairs == 0) return {};
  with_temporary(heap, [&](void* temporary, std::size_t& bytes) {
    check_cuda(cub::DeviceScan::ExclusiveSum(temporary, bytes, brick.data(), brick.data(), brick.size(), heap.stream()),
               "DeviceScan");
  });
  BrickLists lists = bricks_with_pairs(heap, brick, range, pairs);
  lists.triangle = DeviceArray<std::uint32_t>(heap, pairs);
  pairs_by_brick(heap, input, window, range, brick, &lists.triangle, capacity);
  return lists;
}

/// Returns the triangles of each brick by a radix sort of the (triangle, brick) pairs.
BrickLists sorted_lists(DeviceHeap& heap, const InputView& input, const CellWindow& window, KeyRange range,
                        BinCapacity& capacity, CellStats& stats) {
  RawPairs raw = pairs_in(heap, input, window, range, capacity);
  const auto pairs = std::uint32_t(raw.counted.pairs);
  add_to(stats, raw.counted.triangles);
  stats.pairs += pairs;
  BrickLists lists;
  if (pairs == 0) return lists;
  DeviceArray<std::uint32_t> other_key(heap, pairs), other_triangle(heap, pairs);
  cub::DoubleBuffer<std::uint32_t> key(raw.key.data(), other_key.data());
  cub::DoubleBuffer<std::uint32_t> triangle(raw.triangle.data(), other_triangle.data());
  const int bits = std::max(1, key_bits(window));
  with_temporary(heap, [&](void* temporary, std::size_t& bytes) {
    check_cuda(cub::DeviceRadixSort::SortPairs(temporary, bytes, key, triangle, pairs, 0, bits, heap.stream()),
               "DeviceRadixSort");
  });
  // The sort's unused key buffer holds the starts until their number is known.
  lists.bricks = select_indices(heap, pairs, StartsBrick{key.Current()}, key.Alternate());
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

}  // namespace

DeviceArray<SnappedVertex> snap_vertices(DeviceHeap& heap, const InputView& input, const CellWindow& window) {
  DeviceArray<SnappedVertex> out(heap, input.vertex_count);
  snap_kernel<<<grid_of(input.vertex_count, threads), threads, 0, heap.stream()>>>(input, window, out.data());
  check_launch("snap_kernel");
  return out;
}

std::vector<std::uint64_t> pairs_by_unit(DeviceHeap& heap, const InputView& input, const CellWindow& window,
                                         int unit_level, CellStats& stats) {
  const std::size_t units = std::size_t(1) << 3 * (window.levels - unit_level);
  DeviceArray<unsigned long long> counts(heap, units);
  BinCapacity capacity{0};
  for (;;) {
    PairBuffers pair_buffers(heap, capacity);
    counts.clear_to_zero();
    PairSink sink = pair_buffers.sink(all_keys(window));
    sink.unit_pairs = counts.data();
    sink.unit_bits = 3 * unit_level;
    const std::uint64_t nodes = find_pairs(heap, input, window, sink, pair_buffers);
    if (nodes > capacity.nodes) {
      capacity.nodes = nodes + nodes / 16;
      continue;
    }
    add_to(stats, pair_buffers.raw.counted.triangles);
    std::vector<std::uint64_t> host(units);
    heap.bring(host.data(), counts.data(), counts.bytes(), "counting pairs of units");
    return host;
  }
}

BrickLists bin_triangles(DeviceHeap& heap, const InputView& input, const CellWindow& window, KeyRange range,
                         BinCapacity& capacity, CellStats& stats) {
  return range.end - range.first <= max_counted_bricks ? counted_lists(heap, input, window, range, capacity, stats)
                                                       : sorted_lists(heap, input, window, range, capacity, stats);
}

}  // namespace gigabake::kernels
