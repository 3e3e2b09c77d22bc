/// The kernels that pair triangles with bricks.
#pragma once

#include <cstdint>

#include "kernels/body/triangle_bricks.h"
#include "kernels/body/triangle_fate.h"
#include "kernels/cuda/bin.cuh"

namespace gigabake::kernels {

/// A triangle of more bricks than a thread should walk, at an oct-tree node that it may touch.
struct LargeItem {
  std::uint32_t triangle, node;  ///< node: Morton code at the present level
};

/// Counters go on when an array is full: the host then knows what is needed.
struct PairCounters {
  unsigned long long pairs, items[2];
  TriangleCounts<unsigned long long> triangles;
};

/// Where pairs go: side by side as they come; or, with `brick`, each to its brick's place; or nowhere, to be counted.
struct PairSink {
  KeyRange range;  ///< bricks beside it get no pairs
  std::uint32_t* key;
  std::uint32_t* triangle;
  std::uint64_t capacity;
  std::uint32_t* brick;            ///< null, or [key in the range] pairs so far, or the place of the next one
  unsigned long long* unit_pairs;  ///< null, or counts pairs by key >> unit_bits
  int unit_bits;
  LargeItem* items[2];
  std::uint64_t item_capacity;
  PairCounters* counters;
};

__device__ inline void push_pair(const PairSink& sink, std::uint64_t at, std::uint32_t key, std::uint32_t triangle) {
  if (sink.unit_pairs != nullptr) atomicAdd(&sink.unit_pairs[key >> sink.unit_bits], 1ull);
  if (sink.brick != nullptr) at = atomicAdd(&sink.brick[key - sink.range.first], 1u);
  if (at >= sink.capacity) return;
  if (sink.brick == nullptr) sink.key[at] = key;
  sink.triangle[at] = triangle;
}

__device__ inline void push_item(const PairSink& sink, int queue, LargeItem item) {
  const std::uint64_t at = atomicAdd(&sink.counters->items[queue], 1ull);
  if (at < sink.item_capacity) sink.items[queue][at] = item;
}

__global__ void snap_kernel(InputView in, CellWindow window, SnappedVertex* out);

inline constexpr int pair_threads = 256;

/// One thread a triangle, pair_threads a block: small ones are paired at once, large ones go to queue 0 as the root.
__global__ void __launch_bounds__(pair_threads) pair_kernel(InputView in, CellWindow window, PairSink sink);

/// Queue `from` holds items of `level`; their children go to the other queue, or at level 1 to the pairs.
__global__ void descend_kernel(InputView in, CellWindow window, PairSink sink, int from, int level);

}  // namespace gigabake::kernels
