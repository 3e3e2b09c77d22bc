/// Stage 2 of a cell: which triangles concern which brick. A pair is a brick's Morton key and a triangle's index; a
/// superset of the true overlaps costs time, never correctness.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/body/brick_triangle.h"
#include "kernels/body/cell.h"
#include "kernels/cpu/unset_array.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// Brick key in the upper 32 bits, triangle in the lower.
using Pair = std::uint64_t;

GB_HD Pair make_pair(std::uint64_t brick_key, std::uint32_t triangle) { return brick_key << 32 | triangle; }
GB_HD std::uint64_t brick_of(Pair p) { return p >> 32; }
GB_HD std::uint32_t triangle_of(Pair p) { return std::uint32_t(p); }

/// Half-open range of brick keys that is baked at once.
struct Batch {
  std::uint64_t first_key, end_key;
  std::uint64_t pairs;
};

/// Cuts the window's keys into batches of at most about `pairs_per_batch` pairs (a single 1/32768 of the window may
/// exceed it). Batches cover all keys, in ascending order; empty ones are left out.
std::vector<Batch> plan_batches(std::span<const WindowTriangle> triangles, const CellParameters& parameters,
                                std::uint64_t pairs_per_batch, const ThreadPool& pool);

/// The batch's pairs, sorted by brick key.
UnsetArray<Pair> sorted_pairs(std::span<const WindowTriangle> triangles, const CellParameters& parameters,
                              const Batch& batch, const ThreadPool& pool, CellStats& stats);

}  // namespace gigabake::kernels
