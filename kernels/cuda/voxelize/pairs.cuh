/// Kernels that pair triangles with bricks.
#pragma once

#include <cstdint>

#include "kernels/body/voxelize/classify_triangle.h"
#include "kernels/body/voxelize/triangle_bricks.h"
#include "kernels/cuda/voxelize/bin.cuh"

namespace gigabake::kernels {

/// A triangle whose box has too many bricks for one thread, at an octree node that it may overlap.
struct LargeItem {
  std::uint32_t triangle, node;  ///< node: Morton code at the current level
};

/// Counters of pairs and items. They count beyond the arrays' capacities, so that the host can read the required
/// capacities.
struct PairCounters {
  unsigned long long pairs, items[2];
  TriangleCounts<unsigned long long> triangles;
};

/// Output of pairs. Without `brick`, pairs are appended in any order; otherwise they are stored at their brick's place.
/// Pairs beyond `capacity` are only counted.
struct PairSink {
  KeyRange range;  ///< bricks outside it get no pairs
  std::uint32_t* key;
  std::uint32_t* triangle;
  std::uint64_t capacity;
  std::uint32_t* brick;            ///< null, or [key - range.first]: pairs so far, or place of the next pair
  unsigned long long* unit_pairs;  ///< null, or pairs per unit, key >> unit_bits
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

/// Pairs small triangles with their bricks and appends large triangles at the root to queue 0. One thread per triangle.
__global__ void __launch_bounds__(pair_threads) pair_kernel(InputView in, CellWindow window, PairSink sink);

/// Descends one level: tests the children of the items of queue `from` at `level`. Overlapping children go to the other
/// queue, or become pairs at level 1.
__global__ void descend_kernel(InputView in, CellWindow window, PairSink sink, int from, int level);

}  // namespace gigabake::kernels
