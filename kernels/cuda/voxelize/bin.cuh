/// Stages 1 and 2 of a bake on the device. Vertices are snapped once, triangles are paired with the bricks that they
/// may overlap, and the pairs are sorted by brick.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/body/cell.h"
#include "kernels/body/voxelize/window.h"
#include "kernels/cuda/device/input.cuh"
#include "kernels/cuda/device/memory.cuh"

namespace gigabake::kernels {

/// Returns the snapped positions of all vertices, submesh after submesh.
DeviceArray<SnappedVertex> snap_vertices(DeviceHeap& heap, const InputView& input, const CellWindow& window);

/// Half-open range [first, end) of the Morton keys of bricks.
struct KeyRange {
  std::uint32_t first, end;
};
inline KeyRange all_keys(const CellWindow& window) { return {0, std::uint32_t(1) << key_bits(window)}; }

/// Triangles by brick. Brick b has the Morton code key[b] and the elements [start[b], start[b + 1]) of `triangle`. Keys
/// ascend.
struct BrickLists {
  DeviceArray<std::uint32_t> key, start, triangle;
  std::uint32_t bricks = 0;
};

/// Capacities that earlier cells required, so that the pairs of the next cell rarely have to be found twice.
struct BinCapacity {
  std::uint64_t pairs = std::uint64_t(1) << 20, nodes = std::uint64_t(1) << 16;
};

/// Bins the triangles into the bricks of `range`. `input` must have `vertices` or `window`. Adds to stats.triangles,
/// non_finite, zero_area, oversized and bad_uv, which count all triangles for any range, and to stats.pairs.
/// Errors  CudaFailure; DeviceFull, also beyond 2^32-1 pairs.
BrickLists bin_triangles(DeviceHeap& heap, const InputView& input, const CellWindow& window, KeyRange range,
                         BinCapacity& capacity, CellStats& stats);

/// Returns the number of pairs of each octree node `unit_level` levels above the bricks, by Morton key. Adds to the
/// same stats as bin_triangles() except pairs.
/// Errors  CudaFailure.
std::vector<std::uint64_t> pairs_by_unit(DeviceHeap& heap, const InputView& input, const CellWindow& window,
                                         int unit_level, CellStats& stats);

}  // namespace gigabake::kernels
