/// Stage 5 of a cell: the node table, and the removal of bricks that constant nodes represent.
#pragma once

#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"

namespace gigabake::kernels {

/// Builds the nodes of all levels and removes constant bricks from the levels' arrays. A brick is constant if all its
/// 512 voxels exist and are equal in every channel. A branch of equal constant bricks becomes one
/// node.
/// Exact   Expanding the nodes reproduces the levels bit by bit.
/// Errors  std::length_error beyond 2^32-1 nodes.
NodeTable prune(std::vector<Level>& levels, const ThreadPool& pool);

/// Returns the nodes of levels that store all bricks, including constant bricks.
/// Errors  The errors of prune().
NodeTable brick_nodes(const std::vector<Level>& levels);

}  // namespace gigabake::kernels
