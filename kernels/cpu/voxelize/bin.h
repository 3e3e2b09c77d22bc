/// Stage 2 of a cell: pairs of a triangle and a brick that it may overlap. A pair consists of the brick's Morton key
/// and the triangle's index. Pairs whose triangle does not overlap the brick cost time but do not change the result.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"
#include "kernels/body/voxelize/brick_triangle.h"
#include "kernels/cpu/unset_array.h"

namespace gigabake::kernels {

class StoredDepth;

/// The bricks of one level in which a triangle is voxelized. Without `depth`, all bricks that the triangle may touch.
struct BrickChoice {
  const StoredDepth* depth = nullptr;
  int lod = 0;
};

/// A pair: the brick's key in the upper 32 bits, and the triangle's index in the lower 32 bits.
using Pair = std::uint64_t;

GB_HD Pair make_pair(std::uint64_t brick_key, std::uint32_t triangle) { return brick_key << 32 | triangle; }
GB_HD std::uint64_t brick_of(Pair p) { return p >> 32; }
GB_HD std::uint32_t triangle_of(Pair p) { return std::uint32_t(p); }

/// A half-open range of brick keys whose bricks are baked together.
struct Batch {
  std::uint64_t first_key, end_key;
  std::uint64_t pairs;
  std::vector<std::uint64_t> range_pairs = {};  ///< pairs per range of triangles; empty if there are several batches
};

/// Splits the brick keys of the window into batches of at most `pairs_per_batch` pairs. A batch has more pairs only if
/// one of the 32,768 equal parts of the key range has more. Batches are in ascending order and cover all keys with
/// pairs; empty batches are omitted.
/// `parameters` belong to the level of `choice`.
std::vector<Batch> plan_batches(std::span<const WindowTriangle> triangles, const CellParameters& parameters,
                                std::uint64_t pairs_per_batch, const ThreadPool& pool, const BrickChoice& choice = {});

/// Returns the batch's pairs, sorted by brick key.
UnsetArray<Pair> sorted_pairs(std::span<const WindowTriangle> triangles, const CellParameters& parameters,
                              const Batch& batch, const ThreadPool& pool, CellStats& stats,
                              const BrickChoice& choice = {});

}  // namespace gigabake::kernels
