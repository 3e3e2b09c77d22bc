/// Stages 1 and 2 on the device: vertices are snapped once, triangles are paired with the bricks that they may touch,
/// the pairs are sorted by brick.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/body/cell.h"
#include "kernels/body/window.h"
#include "kernels/cuda/input.cuh"
#include "kernels/cuda/memory.cuh"

namespace gigabake::kernels {

/// Snapped positions of all vertices, part after part.
DeviceArray<SnappedVertex> snap_vertices(DeviceHeap& heap, const InputView& input, const CellWindow& window);

/// Bricks by Morton key, [first, end).
struct KeyRange {
  std::uint32_t first, end;
};
inline KeyRange all_keys(const CellWindow& window) { return {0, std::uint32_t(1) << key_bits(window)}; }

/// Triangles by brick: brick b has key[b] and triangle[start[b]] … triangle[start[b + 1]]. Keys ascend.
struct BrickLists {
  DeviceArray<std::uint32_t> key, start, triangle;
  std::uint32_t bricks = 0;
};

/// What earlier cells needed, so that the next one rarely has to be counted first.
struct BinCapacity {
  std::uint64_t pairs = std::uint64_t(1) << 20, nodes = std::uint64_t(1) << 16;
};

/// The bricks of `range` alone. input: with vertices or window. Adds to stats.triangles, non_finite, zero_area,
/// oversized, bad_uv, which are of all triangles whatever the range, and to stats.pairs.
/// Errors  CudaFailure; DeviceFull beyond 2^32-1 pairs too.
BrickLists bin_triangles(DeviceHeap& heap, const InputView& input, const CellWindow& window, KeyRange range,
                         BinCapacity& capacity, CellStats& stats);

/// Pairs of each node of the oct-tree `unit_level` levels above the bricks, by Morton key. Adds to stats as
/// bin_triangles() does, but for pairs.
/// Errors  CudaFailure.
std::vector<std::uint64_t> pairs_by_unit(DeviceHeap& heap, const InputView& input, const CellWindow& window,
                                         int unit_level, CellStats& stats);

}  // namespace gigabake::kernels
