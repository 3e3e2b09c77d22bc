/// Stage 5 of a cell: the node table, without bricks that a constant node represents.
#pragma once

#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/body/cell.h"

namespace gigabake::kernels {

/// Builds the nodes of all levels and removes constant bricks from the levels' arrays. A constant brick has all 512
/// voxels, equal in every channel. If all its descendants have the same value too, the branch becomes one node.
/// Exact   Expanding the nodes reproduces the levels bit by bit.
/// Errors  std::length_error beyond 2^32-1 nodes.
NodeTable prune(std::vector<Level>& levels, const ThreadPool& pool);

/// Returns the nodes of levels that store all bricks, including constant bricks.
/// Errors  Like prune().
NodeTable brick_nodes(const std::vector<Level>& levels);

}  // namespace gigabake::kernels
